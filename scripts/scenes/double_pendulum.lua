-- double_pendulum.lua: two weights on elastic rods swing one below the other; the motion is chaotic. The distance of
-- two runs doubles about every half second, so that after some twenty seconds rounding errors determine the path. The
-- energy is conserved all the same; `hooke bench` measures until when a path is meaningful.
local k = param("k", 4000, "stiffness of the rods, N/m", { min = 1 })
local T = param("duration", 60, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 60, integrator = "blanes_moan", dt = 1 / 960 }

local pivot = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local upper = scene:particle { position = { 1, 0, 0 }, mass = 1 }
local lower = scene:particle { position = { 1, 0, 1 }, mass = 1 }
scene:pin { pivot }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("springs", { edges = { { pivot, upper }, { upper, lower } }, k = k, rest = 1 })

scene:measure("x", function(s) return s:position(lower)[1] end)
scene:measure("z", function(s) return s:position(lower)[3] end)
scene:measure("stretch", function(s) return s:strain("springs") end)
scene:measure("energy", function(s) return s:energy() end)
scene:output("frames", { width = 800, height = 800, color = "speed", range = { 0, 8 }, radius = 0.07,
  camera = { 0, -7, 0 }, target = { 0, 0, 0 }, ground_height = -2.4 })
return scene
