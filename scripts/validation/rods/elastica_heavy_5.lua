-- A cantilever under its own weight, w L^3/EI = 5: the elastica.
local cantilever = require("_cantilever")

return cantilever.elastica("Heavy cantilever, w L^3/EI = 5", function() return cantilever.weight(5) end,
  0.6970047775, 0.4959050446, 1 - 0.84665718, 1e-8,
  { "angle_springs" })
