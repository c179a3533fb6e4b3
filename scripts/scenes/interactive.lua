-- interactive.lua: a flag of springs at a price that is known beforehand: two steps a frame by the predictor of Desbrun,
-- Schroeder and Barr 1999, which smooths the forces by one constant matrix, so that springs of any stiffness are stable.
-- What they pay is that the cloth moves as through honey, and softer than it is.
local N = param("N", 21, "particles along one side", { min = 3, max = 200 })
local k = param("k", 2000, "structural stiffness, N/m", { min = 0 })
local per_frame = param("steps", 2, "in a frame", { min = 1 })

local scene = hooke.scene { duration = 2, fps = 60, dt = 1 / 60 / per_frame, integrator = "desbrun" }

local flag = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.2, u = { 1, 0, 0 }, v = { 0, 0, 1 } }
scene:pin { flag:at(1, 1), flag:at(1, N) }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("wind", { velocity = { 3, 1.5, 0 } })
scene:force("springs", { edges = flag:structural(), k = k, damping = 0.02, label = "structural" })
scene:force("springs", { edges = flag:shear(), k = 0.3 * k, damping = 0.01, label = "shear" })
scene:force("springs", { edges = flag:flexion(), k = 0.01 * k, label = "flexion" })

scene:measure("free corner", function(s) return s:position(flag:at(N, 1))[3] end, { unit = "m" })
scene:measure("stretch", function(s) return s:strain("structural") end)
scene:output("frames", { width = 960, height = 720, color = "none", plain = { 0.25, 0.45, 0.7 }, from = { 0.9, -2.8, 0.8 },
  look_at = { 0.45, 0, 0.4 } })
return scene
