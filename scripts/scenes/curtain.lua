-- curtain.lua: the whole upper row is pinned; the cloth falls from the horizontal and swings below it like a curtain.
-- The scene is well-posed: a small perturbation stays small, so errors of different methods can be compared on it.
local N = param("N", 32, "particles along one side", { min = 3, max = 2048 })
local k = param("k", 1000, "structural stiffness, N/m", { min = 0 })

local scene = hooke.scene { duration = 1.5, fps = 60, integrator = "leapfrog" }

local cloth = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.15 }
local row = {}
for i = 1, N do row[i] = cloth:at(i, N) end
scene:pin(row)

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 0.02 })
scene:force("springs", { edges = cloth:structural(), k = k, damping = 0.02, label = "structural" })
scene:force("springs", { edges = cloth:shear(), k = 0.3 * k, damping = 0.01, label = "shear" })
scene:force("springs", { edges = cloth:flexion(), k = 0.05 * k, damping = 0.005, label = "flexion" })

scene:output("frames", { width = 960, height = 720 })
scene:measure("lowest", function(s)
  local z = 0
  for i = 1, N do z = math.min(z, s:position(cloth:at(i, 1))[3]) end
  return z
end, { unit = "m" })
return scene
