-- A square membrane under the tension T swings across itself, w = pi sqrt(2 T/rho)/L in its first mode. A lattice does
-- so more slowly: w^2 = 4 e (k (1 - cos t) + k_d sin^2 t)/(rho a^2), t = pi/n, e the part by which its springs are
-- shorter at rest; for nu = 1/3 (k_d = k/2) that is less than the membrane's by the part 5 t^2/24.
local validation = require("validation")
local cloth = require("_cloth")

local density, Y, e, nu = 0.1, 8, 0.25, 1 / 3
local exact = math.sqrt(2 * density / (Y * e / (1 - nu))) -- T = (k + 2 k_d) e = (C11 + C12) e

return validation.problem {
  title = "First period of a square membrane, and its dispersion",
  quantities = {
    { name = "period", unit = "s", reference = exact, source = "continuum, L sqrt(2 rho/T)", order = { space = 2 },
      tolerance = 2e-5,
      why = "errors of order 2, 1e-3 at n = 32, leave those of order 4, 1e-6; the amplitude's are 1e-6, too" },
    { name = "error times n^2", reference = 5 * math.pi ^ 2 / 48, source = "dispersion of the lattice, closed form",
      tolerance = 0.01, why = "1e-6 of the period is 1e-3 of its error at n = 32" },
  },
  space = { 8, 16, 32 },
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 4, 6, 8 }, tolerance = 0.05 },
  solve = function(at)
    local n, turn = at.n, at.quick and 400 or 1000
    local h = exact / turn
    local steps = math.floor(2.5 * turn)
    local scene = hooke.scene { duration = steps * h, fps = validation.fps(h), dt = h, integrator = "stoermer" }
    local springs, masses = cloth.squares(n, density, { stiffness = Y, nu = nu })
    local speed = 1e-3 * 2 * math.pi / exact
    local border, mode = cloth.add(scene, n, masses, function() return 0 end, function(x, y)
      return speed * math.sin(math.pi * x) * math.sin(math.pi * y)
    end)
    springs.rest = {}
    for k = 1, #springs.edges do springs.rest[k] = (1 - e) / n * (k > 2 * n * (n + 1) and math.sqrt(2) or 1) end
    scene:force("springs", springs)
    scene:pin(border)
    local period = cloth.period(scene, mode, h, steps)
    return { period, (period / exact - 1) * n ^ 2 }
  end,
}
