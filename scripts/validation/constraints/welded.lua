-- Two particles that are welded together swing as one on the spring that holds the first: with the sum of their masses.
-- Where they are to each other stays.
local validation = require("validation")

local k, m, M, swing = 40, 0.3, 0.7, 0.2
local w = math.sqrt(k / (m + M))
local t_end = 2

return validation.problem {
  title = "Welded particles on a spring",
  quantities = {
    { name = "x at t = 2 s", unit = "m", reference = swing * math.cos(w * t_end), scale = swing,
      source = "closed form, cos sqrt(k/(m + M)) t" },
    { name = "distance of the two", unit = "m", reference = 0.5, tolerance = 1e-12, order = {}, source = "as welded",
      why = "rounding: the equations are linear" },
  },
  time = { 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 1e-5,
  noise = 1e-12,
  why = "order 2, (w h)^2/24 w t = 5e-4 at the finest step, of which terms of order 4 are left",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 5, dt = at.h, integrator = "leapfrog" }
    local hook = scene:particle { position = { -1, 0, 0 }, mass = 1 }
    local a = scene:particle { position = { swing, 0, 0 }, mass = m }
    local b = scene:particle { position = { swing, 0.3, 0.4 }, mass = M }
    scene:pin { hook }
    scene:force("springs", { edges = { { hook, a } }, k = k, rest = 1 })
    scene:constraint("weld", { edges = { { a, b } } })
    local s = scene:run():state()
    local x, y = s:position(a), s:position(b)
    return { x[1], math.sqrt((y[1] - x[1]) ^ 2 + (y[2] - x[2]) ^ 2 + (y[3] - x[3]) ^ 2) }
  end,
}
