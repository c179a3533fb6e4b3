-- A sheet of square cells with springs along sides and both diagonals, half ones on the border, has the elasticity that
-- its material numbers ask for at any number of cells: from the energies of strained sheets.
local validation = require("validation")
local cloth = require("_cloth")

local Y, nu, source = 12, 0.25, "C11 = k + k_d, C12 = C66 = k_d with k = Y/(1 + nu), k_d = nu Y/(1 - nu^2)"

return validation.problem {
  title = "Elasticity of a square lattice",
  quantities = {
    { name = "C11", unit = "N/m", reference = Y / (1 - nu ^ 2), source = source },
    { name = "C12", unit = "N/m", reference = nu * Y / (1 - nu ^ 2), source = source },
    { name = "C66", unit = "N/m", reference = nu * Y / (1 - nu ^ 2), source = source },
  },
  space = { 2, 4, 8 },
  time = { 0.02, 0.01, 0.005 },
  time_label = "strain",
  order = { time = 2 },
  noise = 1e-11, -- of energies that are 1e-5 of those of the springs' lengths
  tolerance = 1e-6,
  why = "errors of the strain squared leave those of its fourth power, 1e-9, with factors of some tens",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 2, 3, 4 }, time = { 0.02, 0.01, 0.005 }, tolerance = 1e-6 },
  solve = function(at)
    local n = at.n
    local scene = hooke.scene {}
    local springs = scene:membrane(scene:grid { nx = n + 1, ny = n + 1 }, { stiffness = Y, nu = nu })
    local function place(k) return ((k - 1) % (n + 1)) / n, ((k - 1) // (n + 1)) / n end
    return cloth.elasticity(function(...)
      return cloth.strain_energy((n + 1) ^ 2, place, springs, 1, ...)
    end, at.h)
  end,
}
