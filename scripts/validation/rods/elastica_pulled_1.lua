-- A cantilever with a dead load at its tip, P L^2/EI = 1: the elastica.
local cantilever = require("_cantilever")

return cantilever.elastica("Pulled cantilever, P L^2/EI = 1", function(n) return cantilever.pull(1, n) end,
  0.4613519497, 0.3017207738, 0.0564332363, 1e-7)
