-- The chain of Fermi, Pasta and Ulam with stiff and soft springs in turn: energy wanders between the stiff ones. Their
-- energies after 10 s, of which the last has only 2e-4.
local validation = require("validation")

local w = 50
local source = "Hairer, Lubich and Wanner, Geometric Numerical Integration, I.5.1; recomputed with 113 bits"

return validation.problem {
  title = "Fermi, Pasta, Ulam: energies of the stiff springs at t = 10 s",
  quantities = {
    { name = "I1", unit = "J", reference = 0.956065119574, source = source },
    { name = "I2", unit = "J", reference = 0.025680529674, source = source },
    { name = "I3", unit = "J", reference = 0.000198333515, source = source },
  },
  time = { 1 / 200, 1 / 400, 1 / 800 },
  order = { time = 4 },
  tolerance = 1e-8,
  why = "order 4, 1e-7 at the finest step; extrapolation gains a factor of 30 or more",
  forces = { springs = { "edges", "k", "rest" }, cubic_springs = { "edges", "k", "rest" } },
  quick = { time = { 1 / 100, 1 / 200, 1 / 400 }, tolerance = 1e-5 },
  solve = function(at)
    local q, v = { (1 - 1 / w) / math.sqrt(2), (1 + 1 / w) / math.sqrt(2), 0, 0, 0, 0 },
      { 0, math.sqrt(2), 0, 0, 0, 0 }
    local scene = hooke.scene { duration = 10, fps = 10, dt = at.h, integrator = "blanes_moan" }
    local ids, stiff, soft = {}, {}, {}
    for i = 0, 7 do -- 3 m apart, so that neighbours do not meet
      ids[i] = scene:particle { position = { 3 * i + (q[i] or 0), 0, 0 }, velocity = { v[i] or 0, 0, 0 }, mass = 1 }
    end
    scene:pin { ids[0], ids[7] }
    for i = 0, 6 do table.insert(i % 2 == 1 and stiff or soft, { ids[i], ids[i + 1] }) end
    scene:force("springs", { edges = stiff, k = w * w / 2, rest = 3 })
    scene:force("cubic_springs", { edges = soft, k = 4, rest = 3 })
    local s, energies = scene:run():state(), {}
    for k, edge in ipairs(stiff) do
      local stretch = s:position(edge[2])[1] - s:position(edge[1])[1] - 3
      local rate = s:velocity(edge[2])[1] - s:velocity(edge[1])[1]
      energies[k] = (rate * rate + w * w * stretch * stretch) / 4
    end
    return energies
  end,
}
