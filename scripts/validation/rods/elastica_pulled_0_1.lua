-- A cantilever with a dead load at its tip, P L^2/EI = 0.1: the elastica.
local cantilever = require("_cantilever")

return cantilever.elastica("Pulled cantilever, P L^2/EI = 0.1", function(n) return cantilever.pull(0.1, n) end,
  0.0499542558, 0.0332953193, 0.000665399963, 3e-7)
