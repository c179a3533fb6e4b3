-- stiff_pendulum.lua: a weight on a spring of 1e6 N/m swings from the horizontal; the path is nearly a circle. The
-- spring can vibrate 160 times per second, which limits the steps of an explicit method, while a swing takes six
-- seconds. Known at t = 10 s for k = 1e6 (BiMD's problem stiffpendul): x = -0.81157637265109929, z =
-- -0.58424934474571282.
local k = param("k", 1e6, "stiffness of the spring, N/m", { min = 1 })

local scene = hooke.scene { duration = 10, fps = 60, integrator = "bdf2", dt = 1 / 960 }

local pivot = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local weight = scene:particle { position = { 1, 0, 0 }, mass = 1 }
scene:pin { pivot }
scene:force("gravity", { g = { 0, 0, -1 } })
scene:force("springs", { edges = { { pivot, weight } }, k = k, rest = 1 })

scene:measure("x", function(s) return s:position(weight)[1] end, { unit = "m" })
scene:measure("z", function(s) return s:position(weight)[3] end, { unit = "m" })
scene:measure("vx", function(s) return s:velocity(weight)[1] end, { unit = "m/s" })
scene:measure("vz", function(s) return s:velocity(weight)[3] end, { unit = "m/s" })
scene:measure("stretch", function(s) return s:strain("springs") end)
scene:output("frames", { width = 960, height = 720, color = "speed", range = { 0, 1.5 }, radius = 0.07,
  from = { 0.9, -4.6, 0.35 }, look_at = { 0, 0, -0.55 }, ground_height = -1.25 })
return scene
