-- A pulse runs along an elastic bar, as N springs, at the speed sqrt(E/rho), and comes back from the fixed end with its
-- sign changed: the speed of its energy on the way, and the displacement on its flank when it is back where it began.
local validation = require("validation")

local EA, mu, L = 8, 0.5, 1
local c, width = math.sqrt(EA / mu), 1 / 16
local from = 3 / 8

local function shape(x) return 1e-3 * math.exp(-((x - from) / width) ^ 2 / 2) end

return validation.problem {
  title = "Wave speed of a bar, and a reflection",
  quantities = {
    { name = "speed of the energy", unit = "m/s", reference = c, source = "d'Alembert, sqrt(E/rho)" },
    { name = "displacement on its flank", unit = "mm", reference = -math.exp(-0.5),
      source = "d'Alembert, u = f(x - c t) - f(2 L - x - c t)" },
  },
  space = { 128, 256, 512 },
  time = { 1 / 1600, 1 / 3200, 1 / 6400 },
  order = { space = 2, time = 2 },
  tolerance = 3e-4,
  why = "order 2, a way of (a/width)^2/8 times 1.25/width widths at the flank, 3e-3 at the finest; its square is left",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 64, 128, 256 }, time = { 1 / 800, 1 / 1600, 1 / 3200 }, tolerance = 0.01 },
  solve = function(at)
    local N, a = at.n, L / at.n
    local back = 2 * (L - from) / c -- it is back at its place
    local half = math.floor(0.25 / c / at.h)
    local steps = math.floor(back / at.h + 0.5)
    local scene = hooke.scene { duration = (steps + 1) * at.h, fps = 1 / at.h, dt = at.h, integrator = "leapfrog" }
    local ids, edges = {}, {}
    for i = 0, N do
      local u = shape(i * a)
      ids[i] = scene:particle { position = { i * a + u, 0, 0 }, mass = mu * a,
        velocity = { c * (i * a - from) / width ^ 2 * u, 0, 0 } } -- -c f'
      if i > 0 then edges[i] = { ids[i - 1], ids[i] } end
    end
    scene:pin { ids[0], ids[N] }
    scene:force("springs", { edges = edges, k = EA / a, rest = a })
    local function place(s)
      local sum, moment = 0, 0
      for i = 1, N do
        local stretch = s:position(ids[i])[1] - s:position(ids[i - 1])[1] - a
        local v, u = s:velocity(ids[i])[1], s:velocity(ids[i - 1])[1]
        local e = EA / a * stretch * stretch / 2 + mu * a * (v * v + u * u) / 4
        sum, moment = sum + e, moment + e * (i - 0.5) * a
      end
      return moment / sum
    end
    local run = scene:run { to = 0 }
    local begin = place(run:state())
    scene:run { to = half * at.h }
    local speed = (place(run:state()) - begin) / (half * at.h)
    scene:run { to = steps * at.h }
    local flank = math.floor((from + width) * N + 0.5)
    return { speed, 1e3 * (run:state():position(ids[flank])[1] - flank * a) }
  end,
}
