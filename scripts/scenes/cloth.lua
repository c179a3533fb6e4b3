-- cloth.lua: a square cloth hung by two corners swings down and sways.
-- Structural springs carry it, shear springs keep the weave square, flexion springs resist folding.
local N = param("N", 32, "particles along one side", { min = 2, max = 2048 })
local k = param("k", 1000, "structural stiffness, N/m", { min = 0 })

local scene = hooke.scene { duration = 2, fps = 60, integrator = "leapfrog" } -- dt: chosen from the stiffness

local cloth = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.15 }
scene:pin { cloth:at(1, N), cloth:at(N, N) }

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 0.02 }) -- acceleration -rate v, 1/s
scene:force("springs", { edges = cloth:structural(), k = k, damping = 0.02, label = "structural" })
scene:force("springs", { edges = cloth:shear(), k = 0.3 * k, damping = 0.01, label = "shear" })
if N > 2 then
  scene:force("springs", { edges = cloth:flexion(), k = 0.05 * k, damping = 0.005, label = "flexion" })
end

scene:output("frames", { width = 1280, height = 720 })
scene:output("table")
scene:measure("sag", function(s) return -s:position(cloth:at((N + 1) // 2, 1))[3] end, { unit = "m" })
return scene
