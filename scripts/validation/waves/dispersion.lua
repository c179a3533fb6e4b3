-- A chain of 16 masses between walls swings in one of its modes: w_n = 2 sqrt(k/m) sin(n pi/34), lengthwise, and across
-- under a tension T, with T/a for k. Modes 4, 8 and 16: the last has two thirds of the continuum's frequency.
local validation = require("validation")

local N, k, m, a = 16, 100, 0.5, 1
local stretched = 0.2 -- each spring: tension k 0.2
local modes = { 4, 8, 16 }
local amplitude = 1e-4

local function period(n, stiffness) return math.pi / (math.sqrt(stiffness / m) * math.sin(n * math.pi / (2 * (N + 1)))) end

local quantities = {}
for i, n in ipairs(modes) do
  quantities[i] = { name = ("longitudinal period of mode %d"):format(n), unit = "s", reference = period(n, k),
    source = "lattice dispersion, w = 2 sqrt(k/m) sin(q a/2) (Brillouin, Wave Propagation in Periodic Structures)" }
  quantities[3 + i] = { name = ("transverse period of mode %d"):format(n), unit = "s",
    reference = period(n, k * stretched / a), source = "the same with T/a for k, to (amplitude/a)^2 = 1e-8" }
end

local function measured(part, n, across)
  local T = period(n, across and k * stretched / a or k)
  local h = part * T
  local steps = math.ceil(1.6 * T / h)
  local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "leapfrog" }
  local ids, edges, shape = {}, {}, {}
  for i = 0, N + 1 do
    shape[i] = math.sin(n * math.pi * i / (N + 1))
    local u = amplitude * shape[i]
    ids[i] = scene:particle { position = { i * a + (across and 0 or u), across and u or 0, 0 }, mass = m }
    if i > 0 then edges[i] = { ids[i - 1], ids[i] } end
  end
  scene:pin { ids[0], ids[N + 1] }
  scene:force("springs", { edges = edges, k = k, rest = a - stretched })
  local zeros = validation.crossings()
  validation.each(scene, h, steps, function(s, t)
    local y, slope = 0, 0 -- the projection on the mode
    for i = 1, N do
      local x, v = s:position(ids[i]), s:velocity(ids[i])
      y = y + shape[i] * (across and x[2] or x[1] - i * a)
      slope = slope + shape[i] * v[across and 2 or 1]
    end
    return zeros(t, y, slope) == 3
  end)
  return zeros.times[3] - zeros.times[1]
end

return validation.problem {
  title = "Dispersion of a lattice: modes of a chain of 16",
  quantities = quantities,
  time = { 1 / 25, 1 / 50, 1 / 100 },
  time_label = "step over period",
  order = { time = 2 },
  tolerance = 5e-6,
  why = "order 2, (w h)^2/24 = 2e-4 at the finest step; a hundredth of it is left, and the amplitude's",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { time = { 1 / 12, 1 / 25, 1 / 50 }, tolerance = 1e-4 },
  solve = function(at)
    local found = {}
    for i, n in ipairs(modes) do
      found[i], found[3 + i] = measured(at.h, n, false), measured(at.h, n, true)
    end
    return found
  end,
}
