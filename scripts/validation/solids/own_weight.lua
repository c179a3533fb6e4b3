-- A bar that hangs from its upper end is stretched by its own weight, by rho g L^2/(2 E) at the lower one: with nu = 0 it
-- is so for any cross-section. The weight is 1e-6 of E, so that strains are as small as that.
local validation = require("validation")

local density, g, E = 1000, 1e-4, 1e5 -- kg/m^3, m/s^2, Pa; L = 1 m

return validation.problem {
  title = "Bar stretched by its own weight",
  quantities = {
    { name = "stretch", unit = "m", reference = density * g / (2 * E), source = "closed form, rho g L^2/(2 E)" },
    { name = "pull at the top", unit = "N/m^2", reference = density * g, source = "closed form, rho g L" },
  },
  space = { 2, 4, 8 },
  order = { space = 2 },
  noise = 1e-7, -- of the equilibrium, whose speeds are below 1e-14 m/s
  tolerance = 2e-5,
  why = "the errors of order 2, 1e-3 at n = 8, leave those of order 4; the strain, 1e-6, adds its square",
  forces = { neo_hookean = { "tetrahedra", "E", "nu", "damping" } },
  quick = { space = { 1, 2, 4 }, tolerance = 3e-3 },
  solve = function(at)
    local n = at.n
    local scene = hooke.scene { duration = 60, fps = 2, dt = 0.05, integrator = { "backward_euler", tolerance = 1e-12 } }
    local bar = scene:block { nx = 2, ny = 2, nz = n + 1, size = { 1 / n, 1 / n, 1 }, density = density }
    local top = { bar:at(1, 1, n + 1), bar:at(2, 1, n + 1), bar:at(1, 2, n + 1), bar:at(2, 2, n + 1) }
    scene:pin(top)
    scene:force("neo_hookean", { tetrahedra = bar:tetrahedra(), E = E, nu = 0, damping = 2e4 })
    scene:force("gravity", { g = { 0, 0, -g } })
    local s = validation.rest(scene, 1, 1e-14, 60):state()
    local pull, low = 0, 0
    for _, id in ipairs(top) do pull = pull - s:force("neo_hookean", id)[3] + s:mass(id) * g end
    for i = 1, 2 do
      for j = 1, 2 do low = low - s:position(bar:at(i, j, 1))[3] / 4 end
    end
    return { low, pull * n * n }
  end,
}
