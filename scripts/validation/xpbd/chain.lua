-- The chain of 20 masses of 1 kg, 0.01 m apart, that hangs from the first: its uppermost link holds 19 of them, 190 N with
-- g = 10. The stiffness is 1e8 N/m; substeps of one iteration each, as Small Steps has it, damp the swing until it rests.
local validation = require("validation")

local n, l, k, g = 20, 0.01, 1e8, 10

return validation.problem {
  title = "Force at the top of a chain of 20 masses (XPBD)",
  quantities = { { name = "force", unit = "N", reference = 190,
    source = "Macklin and others 2019, Small Steps in Physics Simulation: 190 N" } },
  time = { 1 / 6000, 1 / 12000, 1 / 24000 },
  order = { time = 2 },
  tolerance = 1e-5,
  why = "one iteration leaves some g h^2 of the stretch of 1.9e-6 m, 1 % at the finest step, and its square",
  quick = { time = { 1 / 3000, 1 / 6000, 1 / 12000 }, tolerance = 1e-3 },
  solve = function(at)
    local substeps = math.floor(1 / 60 / at.h + 0.5)
    local scene = hooke.scene { duration = 1, fps = 60, dt = 1 / 60,
      integrator = { "xpbd", substeps = substeps, iterations = 1 } }
    local chain = scene:strand { n = n, from = { 0, 0, 0 }, to = { 0, 0, -(n - 1) * l }, mass = n }
    scene:pin { chain:at(1) }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:force("springs", { edges = chain:structural(), k = k })
    local s = scene:run():state()
    return k * (-s:position(chain:at(2))[3] - l)
  end,
}
