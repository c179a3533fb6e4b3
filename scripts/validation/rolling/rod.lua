-- A rod falls on its end, and its impulse J = (1 + e) m v/(1 + 3 cos^2 a) turns it.
local validation = require("validation")

local m, l, v, a, e = 2, 0.5, 1, 0.7, 0.6 -- kg, m, half of its length, m/s, rad against the floor
local J = (1 + e) * m * v / (1 + 3 * math.cos(a) ^ 2)

return validation.problem {
  title = "A rod falls on its end",
  quantities = {
    { name = "speed of its centre", unit = "m/s", reference = J / m - v, scale = v, source = "J = (1 + e) m v/(1 + 3 cos^2 a)" },
    { name = "spin", unit = "rad/s", reference = J * l * math.cos(a) / (m * l ^ 2 / 3), source = "J l cos a/I" },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  tolerance = 1e-13,
  noise = 1e-13,
  why = "the step ends at the impact, whose law is exact",
  quick = { time = { 1e-2, 5e-3, 2.5e-3 } },
  solve = function(at)
    local scene = hooke.scene { duration = 0.05, fps = 20, dt = at.h, integrator = "leapfrog" }
    local c, s = l * math.cos(a), l * math.sin(a)
    local b = scene:rigid { points = { { -c, 0, -s }, { 0, 0, 0 }, { c, 0, s } }, masses = { m / 6, 2 * m / 3, m / 6 },
      position = { 0, 0, s + 0.013 }, velocity = { 0, 0, -v } }
    b:surface { { -c, 0, -s }, { c, 0, s } }
    scene:corrector("obstacle", { restitution = e })
    local state = scene:run():state()
    return { b:velocity(state)[3], math.abs(b:spin(state)[2]) }
  end,
}
