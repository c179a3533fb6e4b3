-- string.lua: a chain pinned at one end falls from the horizontal and swings; its stretch is reported.
local n = param("n", 30, "particles in the chain", { min = 2 })
local k = param("k", 2000, "stiffness of one spring, N/m", { min = 0 })
local damping = param("damping", 0.02, "damping along a spring, N s/m", { min = 0 })

local scene = hooke.scene { duration = 3, fps = 60, integrator = "leapfrog" }

local chain = scene:strand { n = n, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 0.1 }
scene:pin { chain:at(1) }

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 0.05 })
scene:force("springs", { edges = chain:structural(), k = k, damping = damping })

scene:output("frames", { width = 960, height = 720 })
scene:measure("stretch", function(s) return s:strain("springs") end)
scene:measure("tip height", function(s) return s:position(chain:at(n))[3] end, { unit = "m" })
return scene
