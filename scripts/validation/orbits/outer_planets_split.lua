-- The sun and the outer planets for 200,000 days along conic sections about the sun, and kicks by each other: errors are by
-- the ratio of the masses, 1e-3, of its first power with h^10, of its second with h^6, and steps a tenth of Jupiter's year.
local validation = require("validation")
local planets = require("_outer_planets")

return validation.problem {
  title = "The outer planets by wisdom_holman",
  quantities = planets.quantities,
  together = true,
  time = { 500, 400, 320 },
  time_label = "step, d",
  tolerance = 1e-8,
  why = "3e-9 AU at 400 d, and less at the finest step",
  forces = { nbody = { "G" } },
  quick = { time = { 1000, 800, 640 }, tolerance = 2e-6 },
  solve = function(at) return planets.solve("wisdom_holman", at.h) end,
}
