-- A star falls through Plummer's sphere of stars (as a smooth potential) and swings; its period from amplitudes of a half,
-- one and four radii of the sphere.
local numerics = require("numerics")
local validation = require("validation")

local amplitudes = { 0.5, 1, 4 }

-- 4 int_0^A dx/sqrt(2 (Phi(A) - Phi(x))), Phi = -1/sqrt(1 + x^2), with x = A sin u.
local function period(A)
  local at_rest = 1 / math.sqrt(1 + A * A)
  return 4 * numerics.integrate(function(u)
    local x = A * math.sin(u)
    local s = math.sqrt(1 + x * x)
    -- 1/s - at_rest without cancellation: (A^2 - x^2) at_rest/(s (1/at_rest + s))
    return math.sqrt(s * (1 / at_rest + s) / (2 * at_rest))
  end, 0, math.pi / 2)
end

local quantities = {}
for i, A in ipairs(amplitudes) do
  quantities[i] = { name = ("period from %g radii"):format(A), unit = "s", reference = function() return period(A) end,
    source = "quadrature of 4 int dx/v in Plummer's potential (Plummer 1911)" }
end

return validation.problem {
  title = "Radial orbits in Plummer's sphere",
  quantities = quantities,
  time = { 0.05, 0.025, 0.0125 },
  order = { time = 2 },
  tolerance = 1e-7,
  why = "order 2, 1e-5 at the finest step, a hundredth of it extrapolated",
  forces = { central = { "strength", "power", "softening" } },
  quick = { time = { 0.2, 0.1, 0.05 }, tolerance = 1e-5 },
  solve = function(at)
    local found = {}
    for i, A in ipairs(amplitudes) do
      local steps = math.ceil((A < 4 and 15 or 60) / at.h)
      local scene = hooke.scene { duration = steps * at.h, fps = 1 / at.h, dt = at.h, integrator = "leapfrog" }
      local p = scene:particle { position = { A, 0, 0 }, mass = 1 }
      scene:force("central", { strength = 1, power = -2, softening = 1 })
      local falls = validation.crossings(-1)
      validation.each(scene, at.h, steps, function(s, t) return falls(t, s:position(p)[1], s:velocity(p)[1]) == 2 end)
      found[i] = falls.times[2] - falls.times[1]
    end
    return found
  end,
}
