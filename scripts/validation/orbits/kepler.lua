-- A planet on a Kepler ellipse of eccentricity 0.6, one turn and a half later; in steps of pi/K s.
local validation = require("validation")

local t_end = 10

return validation.problem {
  title = "Kepler's ellipse, e = 0.6",
  quantities = {
    { name = "x at t = 10 s", unit = "m", reference = -1.5350235919098137,
      source = "Kepler's equation E - e sin E = t, solved to rounding" },
    { name = "y at t = 10 s", unit = "m", reference = -0.28366840649978086,
      source = "Kepler's equation E - e sin E = t, solved to rounding" },
  },
  together = true,
  time = { 1 / 400, 1 / 800, 1 / 1600 },
  order = { time = 4 },
  tolerance = 1e-8,
  why = "order 4: the finest step is off by about 1e-8, extrapolation gains a factor of ten at least",
  forces = { central = { "strength", "power" } },
  quick = { time = { 1 / 100, 1 / 200, 1 / 400 }, tolerance = 1e-5 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 20, dt = at.h, integrator = "rk4" }
    local p = scene:particle { position = { 0.4, 0, 0 }, velocity = { 0, 2, 0 }, mass = 1 }
    scene:force("central", { strength = 1, power = -2 })
    local x = scene:run():state():position(p)
    return { x[1], x[2] }
  end,
}
