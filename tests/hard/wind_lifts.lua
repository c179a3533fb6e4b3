--[[
what: an updraught lifts a plate that lay still: wind brings energy in, until the plate rises at its terminal velocity
right: closed form: with u the relative wind, u' = g - b u^2, so u = c coth(b c (t + t0)), c^2 = g/b
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4
]]
-- The bound: leapfrog errs by (h r)^2 of the 0.4 m in which the wind takes hold, at the rate r = 2 b W = 29 1/s: 1.5e-3
-- m at h = 1/480 s.
local g, W, drag, density, area, mass = 9.81, 12, 1.2, 1.2, 0.5, 0.3
local scene = hooke.scene { duration = 1.5, fps = 480, tol = 1e-8, accuracy = 2e-3 }

scene:mesh { file = "triangle.obj", mass = mass }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("wind", { velocity = { 0, 0, W }, density = density, drag = drag, lift = 0, friction = 0 })

scene:exact(function(t)
  local b = density * area * drag / (2 * mass)
  local c = math.sqrt(g / b)
  local t0 = math.log((W + c) / (W - c)) / (2 * b * c)
  local function integral(time) return math.log((math.exp(b * c * time) - math.exp(-b * c * time)) / 2) / b end
  local z = W * t - (integral(t + t0) - integral(t0))
  return 0, 0, z, 1, 0, z, 0, 1, z
end)
return scene
