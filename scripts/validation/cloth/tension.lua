-- A membrane is pulled along x to 1.5 times its length, its sides free. It narrows by its Poisson's ratio: rubber to
-- s^-nu at any stretch s, St. Venant and Kirchhoff's sheet by nu (s^2 - 1) of the square of its width. The deformation is
-- even, so that any mesh has it.
local validation = require("validation")
local triangles = require("_triangles")

local s, Y, nu = 1.5, 20, 0.4
local mu = Y / (2 * (1 + nu))
local green = (s * s - 1) / 2

-- Width and force of the sheet in equilibrium.
local function pull(model, kind, n)
  local scene = hooke.scene { duration = 60, fps = 2, dt = 0.1, integrator = "backward_euler" }
  local ids, corners, faces, uv = triangles.add(scene, kind, n,
    function(x, y) return s * x, 0.9 * y, 0 end, { density = 0.1 })
  local left = triangles.where(ids, corners, function(x) return x < 1e-9 end)
  local right = triangles.where(ids, corners, function(x) return x > 1 - 1e-9 end)
  scene:pin(left, { axes = { 0, 1, 0 } })
  scene:pin(right, { axes = { 0, 1, 0 } })
  scene:force("membrane", { triangles = faces, uv = uv, model = model, stiffness = Y, nu = nu, label = "sheet" })
  scene:force("drag", { rate = 10 })
  local state = validation.rest(scene, 1, 1e-13, 60):state()
  local low, high, force = math.huge, -math.huge, 0
  for _, id in ipairs(ids) do
    low, high = math.min(low, state:position(id)[2]), math.max(high, state:position(id)[2])
  end
  for _, id in ipairs(right) do force = force - state:force("sheet", id)[1] end
  return high - low, force
end

return validation.problem {
  title = "Membrane in tension, and how it narrows",
  quantities = {
    { name = "width of rubber", unit = "m", reference = s ^ -nu, source = "closed form, s^-nu" },
    { name = "pull of rubber", unit = "N", reference = mu * (s - s ^ (-2 * nu - 1)),
      source = "closed form, mu (s - s^(-2 nu - 1))" },
    { name = "width of StVK", unit = "m", reference = math.sqrt(1 - 2 * nu * green),
      source = "closed form, sqrt(1 - nu (s^2 - 1))" },
    { name = "pull of StVK", unit = "N", reference = Y * green * s, source = "closed form, Y s (s^2 - 1)/2" },
  },
  space = { 3, 6, 12 },
  order = {},
  noise = 1e-9,
  tolerance = 1e-9,
  why = "exact on any mesh; what is left of the motion to the equilibrium",
  forces = { membrane = { "triangles", "uv", "stiffness", "nu", "model" } },
  quick = { space = { 2, 4, 12 }, tolerance = 1e-9 },
  solve = function(at)
    local width, force = pull("neo_hookean", "irregular", at.n)
    local other, more = pull("stvk", "irregular", at.n)
    return { width, force, other, more }
  end,
}
