-- A spherical pendulum, a particle on a sphere of radius 1 under g = 1, swings between two heights while it goes round. With
-- z = c - r cos u between the heights, the motion is dz/dt = sqrt(2 (z - z1)(z2 - z)(z3 - z)), so that period and angle
-- are integrals over u of smooth functions (Whittaker, Analytical Dynamics, section 55).
local validation = require("validation")
local numerics = require("numerics")
local orbits = require("_orbits")

local z0, v0 = -0.5, 0.7 -- the upper height, and the speed there
local L, E = math.sqrt(1 - z0 * z0) * v0, v0 * v0 / 2 + z0
-- the other roots of 2 (E - z)(1 - z^2) - L^2
local b, c = z0 - E, z0 * z0 - E * z0 - 1
local z1, z3 = (-b - math.sqrt(b * b - 4 * c)) / 2, (-b + math.sqrt(b * b - 4 * c)) / 2

local function over_a_swing(f)
  return 2 * numerics.integrate(function(u)
    local z = (z1 + z0) / 2 - (z0 - z1) / 2 * math.cos(u)
    return f(z) / math.sqrt(2 * (z3 - z))
  end, 0, math.pi)
end

return validation.problem {
  title = "Spherical pendulum",
  quantities = {
    { name = "period of the height", unit = "s", reference = function() return over_a_swing(function() return 1 end) end,
      source = "quadrature (Whittaker, Analytical Dynamics, 55)" },
    { name = "angle round in a period", unit = "rad",
      reference = function() return over_a_swing(function(z) return L / (1 - z * z) end) end,
      source = "quadrature (Whittaker, Analytical Dynamics, 55)" },
  },
  time = { 0.04, 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 1e-7,
  why = "errors of order 2 leave those of order 4: (w h)^4 = 1e-8 at the finest step, times ten for harmonics",
  quick = { time = { 0.1, 0.05, 0.025 }, tolerance = 2e-3 },
  solve = function(at)
    local steps = math.ceil(16 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { math.sqrt(1 - z0 * z0), 0, z0 }, velocity = { 0, v0, 0 }, mass = 2 }
    scene:force("gravity", { g = { 0, 0, -1 } })
    scene:constraint("surface", { particles = { p }, shape = "sphere", radius = 1 })
    local watch = orbits.watch((z0 + z1) / 2)
    validation.each(scene, at.h, steps, function(s, t) watch(s, t, p) end)
    return { watch.period(), watch.advance() }
  end,
}
