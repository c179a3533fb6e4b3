-- A cantilever with a dead load at its tip, P L^2/EI = 2: the elastica.
local cantilever = require("_cantilever")

return cantilever.elastica("Pulled cantilever, P L^2/EI = 2", function(n) return cantilever.pull(2, n) end,
  0.7817498316, 0.4934574804, 0.1606417208, 2e-9,
  { "angle_springs" })
