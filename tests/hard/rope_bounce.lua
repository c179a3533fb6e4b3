--[[
what: a mass falls into a rope and is thrown back, three times; the rope pulls and never pushes, slack at the start
right: closed form in pieces: a parabola while slack, an oscillation about m g/k while taut
must: leapfrog, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
also: leapfrog dt=2e-4; backward_euler dt=2e-4; baraff_witkin dt=2e-4
]]
-- The bound: a step of h across a jump of the stiffness errs by k/m h^2 V/12 = 4e-4 m/s in velocity; there are five in
-- 1.6 s.
local L, g, k, m, drop = 1, 9.81, 2000, 1, 0.3
local scene = hooke.scene { duration = 1.6, fps = 1000, tol = 1e-7, accuracy = 1e-2 }

local hook = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local load = scene:particle { position = { 0, 0, drop - L }, mass = m }
scene:pin { hook }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("ropes", { edges = { { hook, load } }, k = k, rest = L })

scene:exact(function(t)
  local w, mean, V = math.sqrt(k / m), m * g / k, math.sqrt(2 * g * drop)
  local fall, swing = V / g, 2 * (math.pi - math.atan(V / w, mean)) / w -- taut while s > 0: from -V to V
  local s = (t + fall) % (2 * fall + swing) -- from leaving the rope upwards
  if s < 2 * fall then return 0, 0, 0, 0, 0, V * s - g * s * s / 2 - L end
  s = s - 2 * fall
  return 0, 0, 0, 0, 0, mean * math.cos(w * s) - V / w * math.sin(w * s) - mean - L
end)
return scene
