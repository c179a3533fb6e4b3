-- A packet of waves runs along a chain of masses: its energy travels with the group velocity a sqrt(k/m) cos(q a/2), which at
-- q a = 2 is half of that of long waves, and less than the phase velocity. A packet of n masses' width has waves of
-- lengths around 2 pi/q, and some that run back: errors of order 1/n^2.
local validation = require("validation")

local k, m, q = 400, 1, 2 -- a = 1 m
local w = 2 * math.sqrt(k / m) * math.sin(q / 2)
local speed = math.sqrt(k / m) * math.cos(q / 2)

return validation.problem {
  title = "Group velocity in a lattice, q a = 2",
  quantities = { { name = "speed of the energy", unit = "m/s", reference = speed,
    source = "dw/dq of w = 2 sqrt(k/m) sin(q a/2) (Brillouin, Wave Propagation in Periodic Structures)" } },
  space = { 6, 12, 24 },
  space_label = "1/width of the packet",
  time = { 0.01, 0.005, 0.0025 },
  order = { space = 2, time = 2 },
  tolerance = 2e-4,
  why = "order 2 in both, 4e-3 at the finest; their squares are left",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 4, 6, 9 }, tolerance = 5e-2 },
  solve = function(at)
    local width, first = at.n, 6 * at.n
    local T = 3 * width / speed
    local N, steps = math.ceil(12 * width + 3 * width), math.ceil(T / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = 1 / at.h, dt = at.h, integrator = "leapfrog" }
    local ids, edges = {}, {}
    for i = 0, N do
      local A = 1e-3 * math.exp(-((i - first) / width) ^ 2 / 2)
      ids[i] = scene:particle { position = { i + A * math.cos(q * i), 0, 0 }, velocity = { w * A * math.sin(q * i), 0, 0 },
        mass = m }
      if i > 0 then edges[i] = { ids[i - 1], ids[i] } end
    end
    scene:pin { ids[0], ids[N] }
    scene:force("springs", { edges = edges, k = k, rest = 1 })
    local run = scene:run { to = 0 }
    local function place() -- of the energy
      local s, sum, moment = run:state(), 0, 0
      local x = {}
      for i = 0, N do x[i] = s:position(ids[i])[1] - i end
      for i = 0, N do
        local e = m * s:velocity(ids[i])[1] ^ 2 / 2
        if i > 0 then e = e + k * (x[i] - x[i - 1]) ^ 2 / 4 end
        if i < N then e = e + k * (x[i + 1] - x[i]) ^ 2 / 4 end
        sum, moment = sum + e, moment + e * i
      end
      return moment / sum
    end
    local from = place()
    scene:run { to = steps * at.h }
    return (place() - from) / (steps * at.h)
  end,
}
