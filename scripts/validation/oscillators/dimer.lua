-- Two atoms of Lennard-Jones' potential vibrate: the period from small to large swings.
local numerics = require("numerics")
local validation = require("validation")

local cutoff = 6
local energies = { -0.99, -0.5 } -- of the depth, epsilon = 1; reduced mass 1/2

-- The shifted force: V(r) - V(rc) - (r - rc) V'(rc).
local function V(r) return 4 * (r ^ -12 - r ^ -6) end
local function slope(r) return 4 * (-12 * r ^ -13 + 6 * r ^ -7) end
local function shifted(r) return V(r) - V(cutoff) - (r - cutoff) * slope(cutoff) end

local inner = {}
for i, E in ipairs(energies) do
  inner[i] = numerics.root(function(r) return shifted(r) - E end, 0.9, 2 ^ (1 / 6))
end

-- Twice the time from the inner turning point to the outer one; r'' = -V'/mu, mu = 1/2.
local function period(i)
  local function f(_, y) return { y[2], -2 * (slope(y[1]) - slope(cutoff)) } end
  local early = i == 1 and 0.28 or 0.4
  local y = numerics.ode(f, 0, { inner[i], 0 }, early)
  return 2 * (early + numerics.root(function(t) return (t == 0 and y or numerics.ode(f, 0, y, t))[2] end, 0, 0.3))
end

local quantities = {}
for i, E in ipairs(energies) do
  quantities[i] = { name = ("period at E = %g epsilon"):format(E), unit = "s", reference = function() return period(i) end,
    source = "recomputed by extrapolation (Gragg, Bulirsch and Stoer)" }
end

return validation.problem {
  title = "Vibration of a Lennard-Jones dimer",
  quantities = quantities,
  time = { 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 2e-5,
  why = "order 2, 4e-4 at the finest step, of which extrapolation leaves two hundredths",
  forces = { lennard_jones = { "epsilon", "sigma", "cutoff" } },
  quick = { time = { 0.02, 0.01, 0.005 }, tolerance = 1e-4 },
  solve = function(at)
    local found = {}
    for i in ipairs(energies) do
      local steps = math.ceil((i == 1 and 1.5 or 3) / at.h)
      local scene = hooke.scene { duration = steps * at.h, fps = 1 / at.h, dt = at.h, integrator = "leapfrog" }
      local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
      local q = scene:particle { position = { inner[i], 0, 0 }, mass = 1 }
      scene:force("lennard_jones", { epsilon = 1, sigma = 1, cutoff = cutoff })
      local rises = validation.crossings(1) -- of r - 1.12: once a period
      validation.each(scene, at.h, steps, function(s, t)
        return rises(t, s:position(q)[1] - s:position(p)[1] - 1.12, s:velocity(q)[1] - s:velocity(p)[1]) == 2
      end)
      found[i] = rises.times[2] - rises.times[1]
    end
    return found
  end,
}
