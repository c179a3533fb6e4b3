--[[
what: the clamped root of a chain of bars turns 50 times a second, and the chain with it, stretched out by its own inertia
right: closed form: straight along the radius is how it turns steadily, and stably
must: blanes_moan, rk4, dopri5, implicit_midpoint
]]
-- The bound: the clamp turns by 0.3 rad in a step of 1 ms. A method that is off by a part e of the acceleration swings about
-- the radius with an amplitude of some e L; 1 % of 0.4 m is what order 2 leaves.
local W, n, l = 300, 4, 0.1
local scene = hooke.scene { duration = 0.05, fps = 1000, tol = 1e-6, accuracy = 4e-3 }

local ids, bars = {}, {}
for k = 0, n do
  ids[k] = scene:particle { position = { k * l, 0, 0 }, velocity = { 0, W * k * l, 0 }, mass = 0.01 }
  if k > 1 then bars[k - 1] = { ids[k - 1], ids[k] } end
end
scene:pin { ids[0] }
scene:pin({ ids[1] }, { path = function(t)
  local c, s = math.cos(W * t), math.sin(W * t)
  return l * (c - 1), l * s, 0, -l * W * s, l * W * c, 0
end })
scene:constraint("bars", { edges = bars })

scene:exact(function(t)
  local list = {}
  for k = 0, n do list[k + 1] = { k * l * math.cos(W * t), k * l * math.sin(W * t), 0 } end
  return list
end)
return scene
