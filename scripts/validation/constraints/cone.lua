-- A particle on a cone of half angle 30 degrees, without a force: the cone can be rolled out flat, where the path is a straight
-- line. From the distance r of the tip, across, at the speed v: its distance is sqrt(r^2 + v^2 t^2), its angle about the
-- axis atan(v t/r)/sin 30.
local validation = require("validation")

local r, v, t_end, half = 1, 1.5, 1.5, math.pi / 6

return validation.problem {
  title = "Geodesic on a cone",
  quantities = {
    { name = "height at t = 1.5 s", unit = "m", reference = math.sqrt(r * r + (v * t_end) ^ 2) * math.cos(half),
      source = "closed form, the cone rolled out" },
    { name = "angle about the axis", unit = "rad", reference = math.atan(v * t_end / r) / math.sin(half),
      source = "closed form, the cone rolled out" },
  },
  time = { 0.03, 0.015, 0.0075, 0.00375 },
  order = { time = 2 },
  tolerance = 2e-6,
  why = "errors of order 2, 1e-5 at the finest step, of which the measured order leaves a few percent",
  quick = { time = { 0.1, 0.05, 0.025 }, tolerance = 2e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 2, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { r * math.sin(half), 0, r * math.cos(half) }, velocity = { 0, v, 0 } }
    scene:constraint("surface", { particles = { p }, length = 0.5,
      g = function(_, x, y, z) return x * x + y * y - (math.tan(half) * z) ^ 2 end })
    local x = scene:run():state():position(p)
    return { x[3], math.atan(x[2], x[1]) }
  end,
}
