-- Standing waves of a bar between fixed ends: modes 1 and 3 together, u = A (sin(pi x) cos(pi c t) + sin(3 pi x) cos(3 pi c t)/2),
-- whose frequencies a chain of N springs meets to second order. The displacement of the point x = 1/4 at t = 3.3 L/c.
local validation = require("validation")

local A, time = 1e-4, 3.3 -- c = L = 1

local function exact(x, t)
  return math.sin(math.pi * x) * math.cos(math.pi * t) + math.sin(3 * math.pi * x) * math.cos(3 * math.pi * t) / 2
end

return validation.problem {
  title = "Standing waves of a bar",
  quantities = {
    { name = "displacement at x = 1/4", unit = "of A", reference = exact(0.25, time), source = "d'Alembert, Bernoulli" },
    { name = "displacement at x = 1/2", unit = "of A", reference = exact(0.5, time), source = "d'Alembert, Bernoulli" },
  },
  space = { 64, 128, 256 },
  time = { 1 / 320, 1 / 640, 1 / 1280 },
  order = { space = 2, time = 2 },
  tolerance = 2e-4,
  why = "order 2, a phase of (3 pi)^3 3.3/24/n^2, 2e-3 at the finest; its square, and that of the step, is left",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 16, 32, 64 }, time = { 1 / 80, 1 / 160, 1 / 320 }, tolerance = 0.03 },
  solve = function(at)
    local N, a = at.n, 1 / at.n
    local scene = hooke.scene { duration = time, fps = 10, dt = at.h, integrator = "leapfrog" }
    local ids, edges = {}, {}
    for i = 0, N do
      ids[i] = scene:particle { position = { i * a + A * exact(i * a, 0), 0, 0 }, mass = a }
      if i > 0 then edges[i] = { ids[i - 1], ids[i] } end
    end
    scene:pin { ids[0], ids[N] }
    scene:force("springs", { edges = edges, k = N, rest = a })
    local s = scene:run():state()
    return { (s:position(ids[N // 4])[1] - 0.25) / A, (s:position(ids[N // 2])[1] - 0.5) / A }
  end,
}
