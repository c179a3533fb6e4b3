--[[
what: five bars lie straight between two pins and bear loads along themselves: their equations depend on each other there
right: closed form, nothing moves
must: leapfrog, rk4, dopri5, midpoint, implicit_midpoint, bdf2, esdirk4, backward_euler
]]
-- The bound: a start off by 1e-14 of the extent lets the chain off its line by the root of that, 1e-7 times 1 m or so,
-- where there is no force across it; ten times that.
local scene = hooke.scene { duration = 1, fps = 100, accuracy = 1e-5 }
local place, edges = {}, {}
for k = 0, 5 do
  place[k + 1] = { k / 5, 0, 0 }
  if k > 0 then edges[k] = { k, k + 1 } end
end
scene:particles { positions = place, mass = 0.1 }
scene:pin { 1, 6 }
scene:force("gravity", { g = { 9.81, 0, 0 } })
scene:constraint("bars", { edges = edges })
scene:exact(function()
  local at = {}
  for _, x in ipairs(place) do table.move(x, 1, 3, #at + 1, at) end
  return table.unpack(at)
end)
return scene
