-- A ball that rolls inside of a vertical cylinder falls, and rises again: 7/5 z'' = -g - 2/5 W^2 z, so that it goes up and
-- down at sqrt(2/7) of the rate W at which it goes round.
local validation = require("validation")

local g, W, r, a, t_end = 9.81, 6, 0.1, 0.4, 2
local q = math.sqrt(2 / 7) * W

return validation.problem {
  title = "A ball in a vertical cylinder rises again",
  quantities = {
    { name = "height", unit = "m", reference = 5 / 7 * g / q ^ 2 * (math.cos(q * t_end) - 1), scale = 1,
      source = "closed form (Gualtieri, Tokieda et al. 2006, Am. J. Phys. 74, 497)" },
    { name = "place, x", unit = "m", reference = a * math.cos(W * t_end), scale = 1, source = "it goes round evenly" },
    { name = "place, y", unit = "m", reference = a * math.sin(W * t_end), scale = 1, source = "it goes round evenly" },
  },
  together = true,
  time = { 1e-3, 5e-4, 2.5e-4 },
  tolerance = 1e-7,
  why = "errors of order 2 and of order 3 that are as large",
  quick = { time = { 4e-3, 2e-3, 1e-3 }, tolerance = 1e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local b = scene:rigid { shape = "sphere", radius = r, mass = 2, position = { a, 0, 0 }, velocity = { 0, a * W, 0 },
      spin = { 0, 0, -a * W / r } }
    b:surface { { 0, 0, 0 } }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:corrector("obstacle", { shape = "cylinder", hollow = true, size = { 2 * (a + r), 2 * (a + r), 20 }, friction = 5,
      radius = r })
    local x = b:position(scene:run():state())
    return { x[3], x[1], x[2] }
  end,
}
