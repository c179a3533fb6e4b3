--[[
what: two equal cranks and a bar between them turn through the positions in which all lie in one line
right: closed form, both cranks turn uniformly
must: none
]]
-- In the line the cranks could go on in opposite senses as well: there the equations depend on each other, and rounding
-- may decide. All methods of order 2 and above are within the bound, and may say that nobody can know. The bound:
-- leapfrog's (h w)^2/24 w T = 3e-4 rad at h = 1/100 s, times ten for the passages.
local w, first = 3, math.rad(80)
local scene = hooke.scene { duration = 2.5, fps = 100, accuracy = 5e-3 }
local function turned(angle) return math.cos(angle), math.sin(angle) end

local x, z = turned(first)
scene:particles {
  positions = { { 0, 0, 0 }, { 2, 0, 0 }, { x, 0, z }, { 2 + x, 0, z } },
  velocities = { { 0, 0, 0 }, { 0, 0, 0 }, { -w * z, 0, w * x }, { -w * z, 0, w * x } }, mass = 1,
}
scene:pin { 1, 2 }
scene:constraint("bars", { edges = { { 1, 3 }, { 2, 4 }, { 3, 4 } } })
scene:exact(function(t)
  x, z = turned(first + w * t)
  return 0, 0, 0, 2, 0, 0, x, 0, z, 2 + x, 0, z
end)
return scene
