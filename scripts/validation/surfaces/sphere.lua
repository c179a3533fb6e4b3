-- The sphere of radius 1.
local surfaces = require("_surfaces")

return surfaces.problem {
  title = "Sphere",
  shape = { f = function(x, y, z) return x * x + y * y + z * z end, level = 1, inside = "below" },
  gradient = function(x, y, z) return x, y, z end,
  half = 1.3,
  area = 4 * math.pi,
  volume = 4 / 3 * math.pi,
  euler = 2,
  source = "closed form",
}
