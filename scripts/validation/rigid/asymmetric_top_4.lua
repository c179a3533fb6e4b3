-- A free asymmetric top that turns about all three axes, by blanes_moan: compositions of RATTLE steps keep their order, 4.
local validation = require("validation")
local bodies = require("_bodies")

local I, w, t = { 1.5, 2, 3 }, { 0.1, 1, 0.2 }, 16

return validation.problem {
  title = "Free asymmetric top by blanes_moan",
  quantities = bodies.axis(function() return bodies.attitude(I, { 1, 0, 0, 0 }, w, t) end, "Euler's equations, extrapolated to 1e-13"),
  together = true,
  time = { 0.1, 0.05, 0.025 },
  order = { time = 4, within = 0.5 },
  tolerance = 1e-9,
  why = "errors of order 4 leave those of order 6",
  quick = { time = { 0.8, 0.4, 0.2 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "blanes_moan" }
    local body = scene:rigid { mass = 1, inertia = I, spin = w }
    local R = bodies.rows(body, scene:run():state())
    return { R[1][1], R[2][1], R[3][1] }
  end,
}
