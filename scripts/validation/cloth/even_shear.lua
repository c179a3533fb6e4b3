-- The energy of a membrane under pure shear, x -> (cosh e x + sinh e y, sinh e x + cosh e y), per area: on any mesh of
-- any size that of the material, since it is one per area. C = F^T F has the entries cosh 2e, cosh 2e, sinh 2e.
local validation = require("validation")
local triangles = require("_triangles")

local e = 0.3
local u, v, shear, nu = 30, 20, 4, 0.2
local function cosh(x) return (math.exp(x) + math.exp(-x)) / 2 end
local function sinh(x) return (math.exp(x) - math.exp(-x)) / 2 end
local a, c = cosh(2 * e), sinh(2 * e)

local function energy(kind, n, numbers)
  local scene = hooke.scene { duration = 0 }
  local ch, sh = cosh(e), sinh(e)
  local _, _, faces, uv = triangles.add(scene, kind, n, function(x, y) return ch * x + sh * y, 0, sh * x + ch * y end, {})
  local given = { triangles = faces, uv = uv, stiffness = u }
  for key, value in pairs(numbers) do given[key] = value end
  scene:force("membrane", given)
  return scene:run { to = 0 }:state():potential()
end

local along = (math.sqrt(a) - 1) ^ 2 / 2
local green, rest = (a - 1) / 2, 1 - nu ^ 2 * v / u

return validation.problem {
  title = "Energy of a membrane in pure shear, on three meshes",
  quantities = {
    { name = "baraff_witkin, regular", unit = "J", reference = (u + v) * along + shear / 2 * c ^ 2,
      source = "closed form, the two stretches and the shear" },
    { name = "stvk, alternating", unit = "J",
      reference = (u / rest + v / rest + 2 * nu * v / rest) * green ^ 2 / 2 + shear / 2 * c ^ 2,
      source = "closed form, 1/2 E.C E" },
    { name = "neo_hookean, irregular", unit = "J", reference = u / (2 * (1 + nu)) / 2 * (2 * a - 2),
      source = "closed form, 1/2 mu (2 cosh 2e - 2): the area stays the same" },
  },
  space = { 4, 8, 16 },
  order = {},
  tolerance = 1e-13,
  why = "rounding",
  quick = { space = { 2, 3, 4 }, tolerance = 1e-13 },
  forces = { membrane = { "triangles", "uv", "stiffness" } },
  solve = function(at)
    return { energy("regular", at.n, { weft = v, shear = shear }),
      energy("alternating", at.n, { model = "stvk", weft = v, shear = shear, nu = nu }),
      energy("irregular", at.n, { model = "neo_hookean", nu = nu }) }
  end,
}
