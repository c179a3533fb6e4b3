-- A cantilever under its own weight, w L^3/EI = 0.1: the elastica.
local cantilever = require("_cantilever")

return cantilever.elastica("Heavy cantilever, w L^3/EI = 0.1", function() return cantilever.weight(0.1) end,
  0.0166650852, 0.0124984378, 1 - 0.9999107322, 1e-6)
