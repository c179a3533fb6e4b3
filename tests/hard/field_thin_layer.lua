--[[
what: a fast particle crosses a layer of 0.1 mm, in which a field pushes it, between two steps, and so it does with half the step
right: closed form, an even motion, a push, an even motion
must: none
also: leapfrog dt=1/50; rk4 dt=1/50; leapfrog dt=1e-3; rk4 dt=1e-4; bdf2 dt=1/50
]]
-- The bound: a tenth of what the push makes of the way: it raises v^2 = 1 (m/s)^2 by 2 f w = 0.8, so v from 1 to 1.342 m/s
-- for half a second.
local scene = hooke.scene { duration = 1, fps = 50, tol = 1e-6, accuracy = 0.017 }
local at, w, f = 0.4963, 1e-4, 4000 -- m, m, m/s^2

scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 }, mass = 1 }
scene:force("field", { f = function(_, x) return x >= at and x < at + w and f or 0, 0, 0 end })

scene:exact(function(t)
  local v = math.sqrt(1 + 2 * f * w)
  local inside = (v - 1) / f
  if t < at then return t, 0, 0 end
  if t < at + inside then return t + f * (t - at) ^ 2 / 2, 0, 0 end
  return at + w + v * (t - at - inside), 0, 0
end)
return scene
