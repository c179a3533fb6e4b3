-- A chain of light and heavy masses in turn has a gap: no wave swings between sqrt(2 k/M) and sqrt(2 k/m). Its two
-- frequencies at the wave length of 12 masses, on a ring of 12.
local validation = require("validation")

local k, m, M, N = 100, 1, 3, 12
local q = 2 * math.pi / N -- phase from one mass to the next: a wave around the ring

-- w^2 = k (1/m + 1/M) -+ k sqrt((1/m + 1/M)^2 - 4 sin^2 q/(m M))
local function square(sign)
  local sum = 1 / m + 1 / M
  return k * (sum + sign * math.sqrt(sum * sum - 4 * math.sin(q) ^ 2 / (m * M)))
end

local quantities = {}
for i, name in ipairs { "acoustic", "optical" } do
  quantities[i] = { name = name .. " period", unit = "s", reference = 2 * math.pi / math.sqrt(square(i == 1 and -1 or 1)),
    source = "Born and von Karman 1912; Brillouin, Wave Propagation in Periodic Structures, section 15" }
end

-- Standing wave cos(q i), with the ratio of heavy to light amplitudes. The ring is laid out so that the springs stay along
-- x: each mass slides on a line of its own, far from its neighbours' only by rest lengths.
local function measured(part, sign)
  local w2 = square(sign)
  local ratio = (2 * k - m * w2) / (2 * k * math.cos(q)) -- heavy over light
  local h = part * 2 * math.pi / math.sqrt(w2)
  local steps = math.ceil(1.6 / part)
  local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "leapfrog" }
  -- Half a wave with its mirror: masses 0 to 6 of the ring, of which 3 and 9 stand still where cos(q i) = 0. So the
  -- chain from 3 to 9 between walls swings in the same way.
  local ids, edges, weight = {}, {}, {}
  for i = 3, 9 do
    local light = i % 2 == 0
    weight[i] = math.cos(q * i) * (light and 1 or ratio)
    ids[i] = scene:particle { position = { i + 1e-4 * weight[i], 0, 0 }, mass = light and m or M }
    if i > 3 then edges[#edges + 1] = { ids[i - 1], ids[i] } end
  end
  scene:pin { ids[3], ids[9] }
  scene:force("springs", { edges = edges, k = k, rest = 1 })
  local zeros = validation.crossings()
  validation.each(scene, h, steps, function(s, t)
    return zeros(t, s:position(ids[6])[1] - 6, s:velocity(ids[6])[1]) == 3
  end)
  return zeros.times[3] - zeros.times[1]
end

return validation.problem {
  title = "The two branches of a diatomic chain",
  quantities = quantities,
  time = { 1 / 25, 1 / 50, 1 / 100 },
  time_label = "step over period",
  order = { time = 2 },
  tolerance = 5e-6,
  why = "order 2, (w h)^2/24 = 2e-4 at the finest step; a hundredth of it is left",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { time = { 1 / 12, 1 / 25, 1 / 50 }, tolerance = 1e-4 },
  solve = function(at) return { measured(at.h, -1), measured(at.h, 1) } end,
}
