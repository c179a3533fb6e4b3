-- A cantilever with a dead load at its tip, P L^2/EI = 5: the elastica.
local cantilever = require("_cantilever")

return cantilever.elastica("Pulled cantilever, P L^2/EI = 5", function(n) return cantilever.pull(5, n) end,
  1.2153681176, 0.7137915236, 0.3876283607, 2e-9,
  { "angle_springs" })
