-- A free asymmetric top that turns about all three axes, by kahan_li8: compositions of RATTLE steps keep their order, 8.
local validation = require("validation")
local bodies = require("_bodies")

local I, w, t = { 1.5, 2, 3 }, { 0.1, 1, 0.2 }, 16

return validation.problem {
  title = "Free asymmetric top by kahan_li8",
  quantities = bodies.axis(function() return bodies.attitude(I, { 1, 0, 0, 0 }, w, t) end, "Euler's equations, extrapolated to 1e-13"),
  together = true,
  time = { 0.4, 0.2, 0.1 },
  order = { time = 8, within = 0.5 },
  tolerance = 1e-12,
  why = "order 8: 1e-11 at the finest step, of which the order leaves a tenth, and rounding",
  quick = { time = { 1.6, 0.8, 0.4 }, tolerance = 1e-5 },
  solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "kahan_li8" }
    local body = scene:rigid { mass = 1, inertia = I, spin = w }
    local R = bodies.rows(body, scene:run():state())
    return { R[1][1], R[2][1], R[3][1] }
  end,
}
