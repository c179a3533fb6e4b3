-- Every particle of a block follows the same deformation, F = 1 + t G, and the pull on one face is the stress: compressed
-- from all sides it shows the bulk modulus, sheared mu, drawn out along one axis lambda + 2 mu. The material is Hooke's for
-- small strains alone: the levels are the strain, and the moduli are approached in proportion to it.
local validation = require("validation")

local E, nu = 1e5, 0.4
local mu, lambda = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))

-- The stress {xx, yy, zz} on the face x = 1 of a cube of side 1 (of rest area), for F = 1 + strain G.
local function stress(G, strain)
  local scene = hooke.scene { duration = 1, fps = 1, dt = 1, integrator = "leapfrog" }
  local n = 3
  local block = scene:block { nx = n, ny = n, nz = n, density = 1000 }
  for i = 1, n do
    for j = 1, n do
      for k = 1, n do
        local X, d = { (i - 1) / (n - 1), (j - 1) / (n - 1), (k - 1) / (n - 1) }, {}
        for r = 1, 3 do d[r] = strain * (G[r][1] * X[1] + G[r][2] * X[2] + G[r][3] * X[3]) end
        scene:pin({ block:at(i, j, k) },
          { path = function(t) return d[1] * t, d[2] * t, d[3] * t, d[1], d[2], d[3] end })
      end
    end
  end
  scene:force("neo_hookean", { tetrahedra = block:tetrahedra(), E = E, nu = nu })
  local state, pull = scene:run { to = 1 }:state(), { 0, 0, 0 }
  for j = 1, n do
    for k = 1, n do
      local F = state:force("neo_hookean", block:at(n, j, k))
      for c = 1, 3 do pull[c] = pull[c] - F[c] end
    end
  end
  return pull
end

return validation.problem {
  title = "Moduli of a solid at small strains",
  quantities = {
    { name = "bulk modulus", unit = "Pa", reference = lambda + 2 / 3 * mu, source = "closed form, E/(3 (1 - 2 nu))" },
    { name = "shear modulus", unit = "Pa", reference = mu, source = "closed form, E/(2 (1 + nu))" },
    { name = "modulus of strain along one axis", unit = "Pa", reference = lambda + 2 * mu,
      source = "closed form, E (1 - nu)/((1 + nu) (1 - 2 nu))" },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  time_label = "strain",
  order = { time = 1 },
  tolerance = 2e-5,
  why = "what is left is of second order in the strain, some 10 of its squares",
  forces = { neo_hookean = { "tetrahedra", "E", "nu" } },
  quick = { time = { 1e-2, 5e-3, 2.5e-3 }, tolerance = 1e-3 },
  solve = function(at)
    local e = at.h
    return {
      stress({ { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } }, e)[1] / (-3 * e),
      stress({ { 0, 1, 0 }, { 0, 0, 0 }, { 0, 0, 0 } }, e)[1 + 1] / e,
      stress({ { 1, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } }, e)[1] / e,
    }
  end,
}
