-- double_pendulum.lua: two weights on elastic rods swing one below the other; the motion is chaotic. The distance of
-- two runs doubles about every half second, so that after some twenty seconds rounding errors determine the path. The
-- energy is conserved all the same; `hooke bench` measures until when a path is meaningful. rigid=1 makes the rods
-- rigid, as in textbooks: constraints instead of springs, in steps four times as long.
local k = param("k", 4000, "stiffness of the rods, N/m", { min = 1 })
local rigid = param("rigid", 0, "1: bars that cannot stretch, instead of springs", { min = 0, max = 1 })
local T = param("duration", 60, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 60, integrator = "blanes_moan", dt = rigid == 1 and 1 / 240 or 1 / 960 }

local pivot = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local upper = scene:particle { position = { 1, 0, 0 }, mass = 1 }
local lower = scene:particle { position = { 1, 0, 1 }, mass = 1 }
local rods = { { pivot, upper }, { upper, lower } }
scene:pin { pivot }
scene:force("gravity", { g = { 0, 0, -9.81 } })
if rigid == 1 then
  scene:constraint("bars", { edges = rods, length = 1 })
  scene:measure("tension", function(s) return s:constraint_forces("bars")[1] end, { unit = "N" })
else
  scene:force("springs", { edges = rods, k = k, rest = 1 })
  scene:measure("stretch", function(s) return s:strain("springs") end)
end

scene:measure("x", function(s) return s:position(lower)[1] end, { unit = "m" })
scene:measure("z", function(s) return s:position(lower)[3] end, { unit = "m" })
scene:measure("energy", function(s) return s:energy() end, { unit = "J" })
scene:output("frames", { width = 800, height = 800, color = "speed", range = { 0, 8 }, radius = 0.07,
  from = { 0, -7, 0 }, look_at = { 0, 0, 0 }, ground_height = -2.4 })
return scene
