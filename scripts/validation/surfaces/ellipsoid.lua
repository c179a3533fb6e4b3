-- An oblate ellipsoid of half axes 1, 1 and 0.6, of eccentricity 0.8.
local surfaces = require("_surfaces")

local e = 0.8

return surfaces.problem {
  title = "Ellipsoid",
  shape = { f = function(x, y, z) return 1 - x * x - y * y - z * z / 0.36 end },
  gradient = function(x, y, z) return x, y, z / 0.36 end,
  half = 1.3,
  area = 2 * math.pi * (1 + (1 - e * e) / e * math.log((1 + e) / (1 - e)) / 2),
  volume = 4 / 3 * math.pi * 0.6,
  euler = 2,
  source = "closed form of an oblate spheroid",
}
