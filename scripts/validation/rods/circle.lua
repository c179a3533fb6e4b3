-- A straight rod whose shape without energy is an arc relaxes to it: three quarters of a circle.
local cantilever = require("_cantilever")

local curvature = 1.5 * math.pi

return cantilever.problem({
  title = "A straight rod relaxes to an arc",
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 1e-8,
  why = "the places of a polygon of equal angles; errors of order 6 are below (curvature/64)^6",
  noise = 1e-9,
  quick = { space = { 8, 16, 32 }, tolerance = 1e-3 },
}, { { "x of the end/L", math.sin(curvature) / curvature }, { "y of the end/L", (1 - math.cos(curvature)) / curvature } },
  "closed form, sin(kappa L)/kappa and (1 - cos(kappa L))/kappa", function(n, force)
    local state, s = cantilever.equilibrium(n, force, nil, { curvature = curvature })
    local _, down, back = cantilever.tip(state, s, n)
    return 1 - back, -down
  end)
