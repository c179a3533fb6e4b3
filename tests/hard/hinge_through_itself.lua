--[[
what: a wing on a bar swings about its hinge by 4 rad either way: folded shut at pi, and on through itself
right: theta = A sin(w t), w^2 = k/(m r^2), k = 4/3 J (plugins/common/shells/bending.c)
must: dopri5
also: leapfrog dt=1e-3; rk4 dt=1e-3; implicit_midpoint dt=1e-3
]]
-- The bound: a thousandth of the wing's length of 1 m. A hinge that forgot its turns would be thrown on at pi.
local scene = hooke.scene { duration = 3, fps = 50, accuracy = 1e-3 }

-- The edge of 2 m along y; c and d at its middle, 1 m off: triangles of 1 m^2, right angles at c and d.
local rate = math.sqrt(4 / 3) -- k = 4/3 J: right triangles of equal legs
local amplitude = 4
scene:particles { positions = { { 0, -1, 0 }, { 0, 1, 0 }, { -1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 0 } },
  velocities = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, -amplitude * rate }, { 0, 0, 0 } }, mass = 1 }
scene:pin { 1, 2, 3, 5 }
scene:constraint("bars", { edges = { { 5, 4 } } })
scene:force("hinges", { hinges = { { 1, 2, 3, 4 } }, rigidity = 1, rest = 0 })

scene:exact(function(t)
  local angle = amplitude * math.sin(rate * t)
  return 0, -1, 0, 0, 1, 0, -1, 0, 0, math.cos(angle), 0, -math.sin(angle), 0, 0, 0
end)
return scene
