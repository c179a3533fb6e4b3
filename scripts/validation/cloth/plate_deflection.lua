-- A simply supported square plate under a small even load q: the middle sinks by 0.00406235 q L^4/B, for any Poisson's
-- ratio. Hinges and quadratic bending on squares of alternating diagonals, whose corners slide across the plate.
local validation = require("validation")
local cloth = require("_cloth")

local density, B, g = 0.3, 0.02, 1e-4

-- Navier's series: 16/pi^6 sum over odd m, n of (-1)^((m + n)/2 - 1)/(m n (m^2 + n^2)^2).
local function navier()
  local sum = 0
  for m = 1, 301, 2 do
    for n = 1, 301, 2 do sum = sum - (-1) ^ ((m + n) // 2) / (m * n * (m * m + n * n) ^ 2) end
  end
  return 16 / math.pi ^ 6 * sum
end

local forces, quantities = { "hinges", "quadratic_bending" }, {}
for k, force in ipairs(forces) do
  quantities[k] = { name = "deflection B/(q L^4), " .. force, unit = "", reference = navier,
    source = "Navier's series, 0.00406235" }
end

local function sink(n, force)
  local scene = hooke.scene { duration = 60, fps = 2, dt = 0.05, integrator = "backward_euler" }
  local _, masses = cloth.squares(n, density)
  local function zero() return 0 end
  local border = cloth.add(scene, n, masses, zero, zero)
  local inner, edge = {}, {}
  for _, id in ipairs(border) do edge[id] = true end
  for k = 1, (n + 1) ^ 2 do
    if not edge[k] then inner[#inner + 1] = k end
  end
  scene:force(force, { triangles = require("sheet").alternating(n).faces, rigidity = B })
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:force("drag", { rate = 8 })
  scene:pin(border)
  scene:pin(inner, { axes = { 0, 0, 1 } })
  local s = validation.rest(scene, 1, 1e-15, 60):state()
  return -s:position(n // 2 * (n + 1) + n // 2 + 1)[3] * B / (density * g)
end

return validation.problem {
  title = "Deflection of a simply supported plate",
  quantities = quantities,
  space = { 8, 16, 32 },
  order = { space = 2 },
  tolerance = 1e-3,
  why = "errors of order 2, 1e-2 at n = 32, leave those of order 4",
  noise = 1e-8,
  forces = { hinges = { "triangles", "rigidity" } },
  quick = { space = { 4, 6, 8 }, tolerance = 0.05 },
  solve = function(at)
    local found = {}
    for k, force in ipairs(forces) do found[k] = sink(at.n, force) end
    return found
  end,
}
