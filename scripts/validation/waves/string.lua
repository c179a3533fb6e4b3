-- A string under tension between two pegs, as N springs, swings across in its first three modes: f_n = n/(2 L) sqrt(T/mu).
-- A chain is flatter: w_N/w = sin(x)/x with x = n pi/(2 N), which is 1 - (n pi/N)^2/24 + ...; the coefficient is measured, too.
-- The steps, of an order-4 method, leave 1e-10.
local validation = require("validation")

local T, mu, L = 2, 0.5, 1 -- N, kg/m, m
local amplitude = 1e-5

local quantities = {}
for n = 1, 3 do
  quantities[n] = { name = ("period of mode %d"):format(n), unit = "s", reference = 2 * L / n / math.sqrt(T / mu),
    source = "Rayleigh, The Theory of Sound, section 121" }
  quantities[3 + n] = { name = ("dispersion error of mode %d, of 1/N^2"):format(n), reference = -(n * math.pi) ^ 2 / 24,
    source = "series of the lattice's dispersion, w_N/w = sin(x)/x", tolerance = 2e-4 }
end

local function period(N, n)
  local a, T_n = L / N, quantities[n].reference
  local h = math.min(T_n / 100, 0.3 * a / math.sqrt(T / mu))
  local steps = math.ceil(1.6 * T_n / h)
  local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "blanes_moan" }
  local ids, edges, shape = {}, {}, {}
  for i = 0, N do
    shape[i] = math.sin(n * math.pi * i / N)
    ids[i] = scene:particle { position = { i * a, amplitude * shape[i], 0 }, mass = mu * a }
    if i > 0 then edges[i] = { ids[i - 1], ids[i] } end
  end
  scene:pin { ids[0], ids[N] }
  scene:force("springs", { edges = edges, k = T / a, rest = 0 }) -- T at any length: no change by the amplitude
  local zeros = validation.crossings()
  validation.each(scene, h, steps, function(s, t)
    local y, slope = 0, 0
    for i = 1, N - 1 do
      y, slope = y + shape[i] * s:position(ids[i])[2], slope + shape[i] * s:velocity(ids[i])[2]
    end
    return zeros(t, y, slope) == 3
  end)
  return zeros.times[3] - zeros.times[1]
end

return validation.problem {
  title = "Frequencies of a string, and their error of dispersion",
  quantities = quantities,
  space = { 8, 16, 32, 64 },
  order = { space = 2 },
  tolerance = 1e-5,
  why = "order 2, 9e-4 at N = 64 for mode 3, leaves order 4, (3 pi/64)^4/1920 times 4, and the steps'; the coefficient is"
    .. " a difference, in which these count N^2 times",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 6, 12, 24 }, tolerance = 5e-3 },
  solve = function(at)
    local found = {}
    for n = 1, 3 do
      found[n] = period(at.n, n)
      found[3 + n] = (quantities[n].reference / found[n] - 1) * at.n ^ 2
    end
    return found
  end,
}
