--[[
what: two grains start inside each other and burst apart
right: closed form, a quarter of a wave, then flight
must: leapfrog, stoermer, blanes_moan, rk4, dopri5
also: leapfrog dt=2e-3; rk4 dt=5e-3; euler dt=1e-4
]]
-- The bound: the contact ends inside a step of 1/20000 s, where its force is 0 with a kink, so that methods of order 2
-- keep theirs: (w h)^2/12 of the speed of 45 m/s for 0.04 s, w = 447 1/s; twice that.
local scene = hooke.scene { duration = 0.05, fps = 20000, tol = 1e-8, accuracy = 1.5e-4 }
local R, k, m, deep = 0.1, 1e5, 1, 0.1 -- m, N/m, kg, m
local w = math.sqrt(2 * k / m)
scene:particles { positions = { { 0, 0, 0 }, { 2 * R - deep, 0, 0 } }, mass = m }
scene:force("soft_spheres", { radius = R, stiffness = k, restitution = 1, friction = 0 })
scene:exact(function(t)
  local free = t - math.pi / 2 / w
  local d = 2 * R - deep * math.cos(w * t)
  if free > 0 then d = 2 * R + deep * w * free end
  return R - deep / 2 - d / 2, 0, 0, R - deep / 2 + d / 2, 0, 0
end)
return scene
