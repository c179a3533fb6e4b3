--[[
what: a joint folded to within 2 degrees, where its stiffness is 1e4 times that of the straight rod, springs open
right: closed form: the energy 2 b tan^2(phi/2) of a turn phi and a bar of length l make sin(phi/2) swing like a mass on
  a spring, sin(phi/2) = s cos(w t), w^2 = b/(m l^2 (1 - s^2))
must: dopri5, arkode, esdirk4, stoermer5
]]
-- The bound: 1e-3 m of a swing of 1 m; a period is 2 pi/w = 0.11 s.
local b, l, s = 1, 1, math.sin(math.rad(178 / 2))
local w = math.sqrt(b / (1 - s * s)) / l
local T = 2.25 * 2 * math.pi / w
local scene = hooke.scene { duration = T, fps = 1000, accuracy = 1e-3 }

local function place(t)
  local phi = 2 * math.asin(s * math.cos(w * t))
  return l * math.cos(phi), l * math.sin(phi), 0
end

local wall = scene:particle { position = { -1, 0, 0 }, mass = 1 }
local joint = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local free = scene:particle { position = { place(0) }, mass = 1 }
scene:pin { wall, joint }
scene:constraint("bars", { edges = { { joint, free } } })
scene:force("rods", { edges = { { wall, joint }, { joint, free } }, EI = b * l / 2, rest = "straight" }) -- half a cell

scene:exact(function(t)
  local x, y, z = place(t)
  return -1, 0, 0, 0, 0, 0, x, y, z
end)
return scene
