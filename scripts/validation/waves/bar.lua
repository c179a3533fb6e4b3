-- An elastic bar between fixed ends, as a chain of N springs, swings lengthwise in its first mode: the period from the
-- times at which the middle passes its place. w = sqrt(E/rho) pi/L, with an error of (pi/N)^2/24 in the chain.
local validation = require("validation")

local periods, amplitude = 3, 1e-3

return validation.problem {
  title = "First longitudinal period of a bar",
  quantities = {
    { name = "period", unit = "s", reference = 2, source = "continuum, T = 2 L sqrt(rho/E)" },
  },
  space = { 8, 16, 32 },
  time = { 0.01, 0.005, 0.0025 },
  order = { space = 2, time = 2 },
  tolerance = 3e-6,
  why = "the errors of order 2, 4e-4 at n = 32, leave those of order 4, (pi/32)^4/1920 and the like",
  forces = { springs = { "edges", "k" } },
  quick = { space = { 4, 8, 16 }, time = { 0.04, 0.02, 0.01 }, tolerance = 1e-3 },
  solve = function(at)
    local N, steps = at.n, math.floor(2 * periods * 1.02 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local ids, edges = {}, {}
    for i = 0, N do
      local s = i / N
      ids[i] = scene:particle { position = { s, 0, 0 }, mass = 1 / N,
        velocity = { amplitude * math.sin(math.pi * s), 0, 0 } }
      if i > 0 then edges[i] = { ids[i - 1], ids[i] } end
    end
    scene:pin { ids[0], ids[N] }
    scene:force("springs", { edges = edges, k = N }) -- E A = 1, rho A = 1, L = 1
    local middle, rises = ids[N // 2], validation.crossings(1)
    validation.each(scene, at.h, steps, function(s, t)
      if t > 0 then rises(t, s:position(middle)[1] - 0.5, s:velocity(middle)[1]) end
    end)
    return (rises.times[#rises.times] - rises.times[1]) / (#rises.times - 1)
  end,
}
