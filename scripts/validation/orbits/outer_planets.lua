-- The sun and the outer planets for 200,000 days, 550 years; units: the earth's distance, days, masses of the sun.
local validation = require("validation")
local planets = require("_outer_planets")

return validation.problem {
  title = "The outer planets, 550 years",
  quantities = planets.quantities,
  together = true,
  time = { 100, 50, 25 },
  time_label = "step, d",
  order = { time = 4, within = 0.5 },
  tolerance = 1e-7,
  why = "order 4, 1e-7 AU at the finest step (Jupiter has gone 46 times round)",
  forces = { nbody = { "G" } },
  quick = { time = { 200, 100, 50 }, tolerance = 1e-5 },
  solve = function(at) return planets.solve("blanes_moan", at.h) end,
}
