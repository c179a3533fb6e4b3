--[[
what: a field in Lua that pushes for 1 ms, at a moment that only it knows, between the steps of a whole frame
right: closed form: rest, a parabola, a straight line
must: none
also: leapfrog dt=1/60; rk4 dt=1/60; leapfrog dt=1e-4; bdf2 dt=1/60
]]
-- The bound: a part in 8000 of the way, 8 m.
local push, from, to = 1e4, 0.2071, 0.2081
local scene = hooke.scene { duration = 1, fps = 60, tol = 1e-8, accuracy = 1e-3 }
scene:particle { position = { 0, 0, 0 }, mass = 0.7 }
scene:force("field", { f = function(t, x, y) return t >= from and t < to and 0.7 * push * (1 + y) or 0, 0 * x, 0 end })
scene:exact(function(t)
  local v, x = push * (to - from), push * (to - from) ^ 2 / 2
  return x + v * (t - to), 0, 0
end)
return scene
