-- A square membrane under tension swings in its modes (1, 1) and (1, 2): w = pi sqrt(T/mu) sqrt(i^2 + j^2)/L. A net of
-- n x n meshes, whose springs have the tension T L/n.
local validation = require("validation")

local T, mu, L = 1, 1, 1 -- N/m, kg/m^2, m
local modes = { { 1, 1 }, { 1, 2 } }
local amplitude = 1e-5

local quantities = {}
for i, m in ipairs(modes) do
  quantities[i] = { name = ("period of mode (%d, %d)"):format(m[1], m[2]), unit = "s",
    reference = 2 / math.sqrt(m[1] ^ 2 + m[2] ^ 2), source = "Rayleigh, The Theory of Sound, section 195" }
end

local function measured(n, part, mode, period)
  local h, a, steps = part * period, L / n, math.ceil(1.6 / part)
  local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "leapfrog" }
  local id, shape, edges, rim, free = {}, {}, {}, {}, {}
  for i = 0, n do
    id[i], shape[i] = {}, {}
    for j = 0, n do
      shape[i][j] = math.sin(mode[1] * math.pi * i / n) * math.sin(mode[2] * math.pi * j / n)
      id[i][j] = scene:particle { position = { i * a, j * a, amplitude * shape[i][j] }, mass = mu * a * a }
      local border = i == 0 or j == 0 or i == n or j == n
      table.insert(border and rim or free, { id[i][j], shape[i][j] })
      if i > 0 then edges[#edges + 1] = { id[i - 1][j], id[i][j] } end
      if j > 0 then edges[#edges + 1] = { id[i][j - 1], id[i][j] } end
    end
  end
  local fixed = {}
  for k, p in ipairs(rim) do fixed[k] = p[1] end
  scene:pin(fixed)
  scene:force("springs", { edges = edges, k = T, rest = 0 }) -- without a rest length the tension is k a, in any direction
  local zeros = validation.crossings()
  validation.each(scene, h, steps, function(s, t)
    local y, slope = 0, 0
    for _, p in ipairs(free) do
      y, slope = y + p[2] * s:position(p[1])[3], slope + p[2] * s:velocity(p[1])[3]
    end
    return zeros(t, y, slope) == 3
  end)
  return zeros.times[3] - zeros.times[1]
end

return validation.problem {
  title = "A square membrane",
  quantities = quantities,
  space = { 8, 16, 32 },
  time = { 1 / 50, 1 / 100, 1 / 200 },
  time_label = "step over period",
  order = { space = 2, time = 2 },
  tolerance = 2e-5,
  why = "order 2 in both, 4e-4 at n = 32 for (1, 2); their squares and product are left",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 4, 8, 16 }, time = { 1 / 25, 1 / 50, 1 / 100 }, tolerance = 1e-3 },
  solve = function(at)
    local found = {}
    for i, mode in ipairs(modes) do found[i] = measured(at.n, at.h, mode, quantities[i].reference) end
    return found
  end,
}
