-- Duffing's oscillator x'' = -x - x^3 has a period that falls with its amplitude.
local numerics = require("numerics")
local validation = require("validation")

local amplitudes = { 0.5, 1, 3 }

local function period(A)
  local w = math.sqrt(1 + A * A)
  return 4 / w * numerics.ellipk(A / w / math.sqrt(2))
end

local quantities = {}
for i, A in ipairs(amplitudes) do
  quantities[i] = { name = ("period at amplitude %g m"):format(A), unit = "s", reference = period(A),
    source = "4 K(k)/w, w^2 = 1 + A^2, k^2 = A^2/(2 w^2) (Byrd and Friedman, Handbook of Elliptic Integrals)" }
end

return validation.problem {
  title = "Period of Duffing's oscillator",
  quantities = quantities,
  time = { 0.02, 0.01, 0.005, 0.0025 },
  order = { time = 2 },
  tolerance = 3e-9,
  why = "order 2, 1e-5 at the finest step and the largest amplitude; extrapolation leaves the order 4, a part of 1e-4",
  forces = { central = { "strength", "power" } },
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-5 },
  solve = function(at)
    local found = {}
    for i, A in ipairs(amplitudes) do
      local steps = math.ceil(1.1 * period(A) * 1.25 / at.h)
      local scene = hooke.scene { duration = steps * at.h, fps = 1 / at.h, dt = at.h, integrator = "leapfrog" }
      local p = scene:particle { position = { A, 0, 0 }, mass = 1 }
      scene:force("central", { strength = 1, power = 1 })
      scene:force("central", { strength = 1, power = 3 })
      local falls = validation.crossings(-1)
      validation.each(scene, at.h, steps, function(s, t) return falls(t, s:position(p)[1], s:velocity(p)[1]) == 2 end)
      found[i] = falls.times[2] - falls.times[1]
    end
    return found
  end,
}
