-- A ball that rolls on a turntable of the rate W goes round a circle at the rate 2/7 W, about a place that the start
-- determines: v = 2/7 W x (x - c).
local validation = require("validation")

local W, r, speed, t_end = 2, 0.2, 0.5, 4
local Q = 2 / 7 * W

return validation.problem {
  title = "A ball on a turntable goes round at 2/7 of its rate",
  quantities = {
    { name = "place, x", unit = "m", reference = 1 + speed / Q * (math.cos(Q * t_end) - 1), scale = 1,
      source = "closed form (Ehrlich and Tuszynski 1995, Am. J. Phys. 63, 351)" },
    { name = "place, y", unit = "m", reference = speed / Q * math.sin(Q * t_end), scale = 1,
      source = "closed form (Ehrlich and Tuszynski 1995)" },
  },
  together = true,
  time = { 4e-3, 2e-3, 1e-3 },
  order = { time = 2 },
  tolerance = 1e-8,
  why = "errors of order 2 leave those of order 3 and 4",
  quick = { time = { 2e-2, 1e-2, 5e-3 }, tolerance = 1e-5 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local b = scene:rigid { shape = "sphere", radius = r, mass = 2, position = { 1, 0, r }, velocity = { 0, speed, 0 },
      spin = { (W - speed) / r, 0, 0 } }
    b:surface { { 0, 0, 0 } }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    scene:corrector("obstacle", { friction = 0.5, radius = r, rotation = function(t) return 0, 0, W * t end })
    local x = b:position(scene:run():state())
    return { x[1], x[2] }
  end,
}
