-- A chain of 1 m hangs from its upper end and swings a little: w_k = j_0k/2 sqrt(g/L), the zeros of the Bessel function J_0.
-- Bars of 1/n with lumped masses, half of one at the lower end. It starts in the shape of the n bars' own mode, so that one
-- frequency is in its motion: the shape follows from the balance of forces, from the lower end upwards.
local validation = require("validation")
local numerics = require("numerics")

local g, amplitude = 9.81, 1e-4

-- The displacements at joints 0 to n of a mode near the frequency w of the continuum.
local function shape(n, w)
  local l, x = 1 / n, {}
  local function top(w2)
    local pull, below = 0, 0 -- the weight that hangs from bar k, and the force that turns it
    x[n] = 1
    for k = n, 1, -1 do
      local m = l * (k == n and 0.5 or 1)
      pull, below = pull + m * g, below + m * w2 * x[k]
      x[k - 1] = x[k] - below * l / pull
    end
    return x[0]
  end
  local w2 = numerics.root(top, 0.85 * w * w, 1.1 * w * w)
  top(w2)
  return x
end

local quantities = {}
for k = 1, 3 do
  quantities[k] = { name = ("frequency %d"):format(k), unit = "rad/s",
    reference = function() return numerics.bessel_zero(0, k) / 2 * math.sqrt(g) end,
    source = "D. Bernoulli 1732, Euler 1781: j_0k/2 sqrt(g/L)" }
end

return validation.problem {
  title = "A hanging chain's small swings",
  quantities = quantities,
  space = { 32, 64, 128 },
  time = { 0.002, 0.001, 0.0005 },
  order = { space = 2, time = 2 },
  tolerance = 1e-5,
  why = "errors of order 2, 2e-3 of the third mode at n = 128, leave those of order 4, their square and some ten times that",
  quick = { space = { 16, 32, 64 }, time = { 0.008, 0.004, 0.002 }, tolerance = 5e-3 },
  solve = function(at)
    local got = {}
    for mode = 1, 3 do
      local n, w = at.n, numerics.bessel_zero(0, mode) / 2 * math.sqrt(g)
      local steps = math.ceil(1.4 * 2 * math.pi / w / at.h)
      local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
      local ids, edges, x, z = {}, {}, shape(n, w), 0
      for k = 0, n do
        if k > 0 then z = z - math.sqrt(1 / n ^ 2 - (amplitude * (x[k] - x[k - 1])) ^ 2) end
        ids[k] = scene:particle { position = { amplitude * x[k], 0, z }, mass = (k == n and 0.5 or 1) / n }
        if k > 0 then edges[k] = { ids[k - 1], ids[k] } end
      end
      scene:pin { ids[0] }
      scene:force("gravity", { g = { 0, 0, -g } })
      scene:constraint("bars", { edges = edges })
      local falls = validation.crossings(-1)
      validation.each(scene, at.h, steps, function(s, t)
        falls(t, s:position(ids[n])[1], s:velocity(ids[n])[1])
        return #falls.times == 2
      end)
      got[mode] = 2 * math.pi / (falls.times[2] - falls.times[1])
    end
    return got
  end,
}
