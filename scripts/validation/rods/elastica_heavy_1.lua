-- A cantilever under its own weight, w L^3/EI = 1: the elastica.
local cantilever = require("_cantilever")

return cantilever.elastica("Heavy cantilever, w L^3/EI = 1", function() return cantilever.weight(1) end,
  0.1651155605, 0.123471402, 1 - 0.9912463953, 3e-7)
