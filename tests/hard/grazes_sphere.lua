--[[
what: a fast particle grazes a sphere, 1e-8 of its radius from passing it: the distance has almost a double root, and the
  deflection is 2.8e-4 rad
right: closed form, a reflection at the point of impact
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4, imex, symplectic_euler, euler
]]
-- The bound: rounding of 1e-16 m of the distance moves the impact along the sphere by 1e-16/1.4e-4 m, and the normal by as much in
-- radians: nothing. The deflection is 2.8e-4 m after 1 m; a hundredth of that.
local R, v = 0.5, 20
local b = R * (1 - 1e-8)
local scene = hooke.scene { duration = 0.1, fps = 50, dt = 0.02, tol = 1e-8, accuracy = 3e-6 }

scene:particle { position = { -0.9, b, 0 }, velocity = { v, 0, 0 }, mass = 1 }
scene:corrector("obstacle", { shape = "sphere", size = { 2 * R, 2 * R, 2 * R }, restitution = 1 })

scene:exact(function(t)
  local back = math.sqrt(R * R - b * b)
  local hit = (0.9 - back) / v
  if t < hit then return -0.9 + v * t, b, 0 end
  local nx, ny = -back / R, b / R
  local s = t - hit
  return -back + (v - 2 * v * nx * nx) * s, b - 2 * v * nx * ny * s, 0
end)
return scene
