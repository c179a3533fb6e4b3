-- A particle on an oblate ellipsoid, without a force: its path is a geodesic, which does not close. Clairaut's relation
-- gives the time between two passages of the equator northwards and the longitude meanwhile; sin b = sin bm sin u makes the
-- integrals smooth (b is the reduced latitude). The surface is a function, its gradient differences.
local validation = require("validation")
local numerics = require("numerics")
local orbits = require("_orbits")

local a, c, bm, speed = 1, 0.6, 1, 1.3 -- m, m, rad, m/s

local function over_a_turn(f)
  return 4 * numerics.integrate(function(u)
    local s = math.sin(bm) * math.sin(u)
    return f(1 - s * s) * math.sqrt(a * a * s * s + c * c * (1 - s * s))
  end, 0, math.pi / 2)
end

return validation.problem {
  title = "Geodesic on an ellipsoid",
  quantities = {
    { name = "time between passages of the equator", unit = "s",
      reference = function() return over_a_turn(function() return 1 / speed end) end,
      source = "Clairaut's relation, quadrature" },
    { name = "longitude meanwhile", unit = "rad",
      reference = function() return over_a_turn(function(cos2) return math.cos(bm) / (a * cos2) end) end,
      source = "Clairaut's relation, quadrature" },
  },
  time = { 0.04, 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 4e-7,
  why = "errors of order 2 leave those of order 4: (w h)^4 at the finest step for the third harmonic, w = 5/s",
  quick = { time = { 0.08, 0.04, 0.02 }, tolerance = 5e-3 },
  solve = function(at)
    local steps = math.ceil(9 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { a, 0, 0 }, velocity = { 0, speed * math.cos(bm), speed * math.sin(bm) } }
    scene:constraint("surface", { particles = { p },
      g = function(_, x, y, z) return (x * x + y * y) / (a * a) + z * z / (c * c) - 1 end })
    local watch = orbits.watch(0, true)
    validation.each(scene, at.h, steps, function(s, t) watch(s, t, p) end)
    return { watch.period(), watch.advance() }
  end,
}
