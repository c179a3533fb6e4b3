-- Equilateral triangles with springs k along their sides are an isotropic sheet of E = 2 k/sqrt(3) and nu = 1/3: a
-- parallelogram of them, whose border has the half of k that scene:membrane gives it.
local validation = require("validation")
local cloth = require("_cloth")

local k = 3
local Y = 2 * k / math.sqrt(3)

return validation.problem {
  title = "Elasticity of a triangular lattice",
  quantities = {
    { name = "E", unit = "N/m", reference = Y, source = "2 k/sqrt(3)" },
    { name = "nu", unit = "", reference = 1 / 3, source = "closed form, springs along edges in an isotropic lattice" },
    { name = "C66", unit = "N/m", reference = math.sqrt(3) * k / 4, source = "sqrt(3) k/4" },
  },
  space = { 2, 4, 8 },
  time = { 0.02, 0.01, 0.005 },
  time_label = "strain",
  order = { time = 2 },
  noise = 1e-11,
  tolerance = 1e-6,
  why = "errors of the strain squared leave those of its fourth power, 1e-9, with factors of some tens",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 2, 3, 4 }, time = { 0.02, 0.01, 0.005 }, tolerance = 1e-6 },
  solve = function(at)
    local n, h = at.n, math.sqrt(3) / 2
    local function place(q)
      local i, j = (q - 1) % (n + 1), (q - 1) // (n + 1)
      return (i + j / 2) / n, j * h / n
    end
    local vertices, faces = {}, {}
    for q = 1, (n + 1) ^ 2 do vertices[q] = { place(q) } vertices[q][3] = 0 end
    for j = 0, n - 1 do
      for i = 1, n do
        local a = j * (n + 1) + i
        faces[#faces + 1] = { a, a + 1, a + n + 1 }
        faces[#faces + 1] = { a + 1, a + n + 2, a + n + 1 }
      end
    end
    local scene = hooke.scene {}
    local springs = scene:membrane(scene:mesh { vertices = vertices, faces = faces }, { stiffness = Y })
    return cloth.elasticity(function(...)
      return cloth.strain_energy((n + 1) ^ 2, place, springs, h, ...)
    end, at.h)
  end,
}
