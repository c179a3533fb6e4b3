-- Prey and predators, u' = u (1 - v), v' = v (u - 1) (Lotka 1925, Volterra 1926), as a channel of two numbers: the period
-- of the cycle through (2, 1), and what it conserves.
local numerics = require("numerics")
local validation = require("validation")

-- The time around the cycle, by extrapolation: v - 1 rises through 0 where u > 1 again after a period.
local function period()
  local function f(_, y) return { y[1] * (1 - y[2]), y[2] * (y[1] - 1) } end
  local near = numerics.ode(f, 0, { 2, 1 }, 6.2)
  return 6.2 + numerics.root(function(t) return (t == 0 and near or numerics.ode(f, 0, near, t))[2] - 1 end, 0, 1.2)
end

local function invariant(u, v) return u - math.log(u) + v - math.log(v) end

return validation.problem {
  title = "Lotka and Volterra: prey and predators",
  quantities = {
    { name = "period", unit = "s", reference = period, source = "recomputed by extrapolation (Gragg, Bulirsch and Stoer)" },
    { name = "u - ln u + v - ln v at t = 10 s", reference = invariant(2, 1), order = {},
      source = "Volterra 1926: it is conserved" },
  },
  time = { 0.025, 0.0125, 0.00625 },
  order = { time = 4, within = 0.4 },
  tolerance = 1e-8,
  noise = 1e-12,
  why = "order 4, 1e-8 at the finest step",
  quick = { time = { 0.1, 0.05, 0.025 }, tolerance = 1e-6 },
  solve = function(at)
    local h, steps = at.h, math.floor(10 / at.h + 0.5)
    local scene = hooke.scene { duration = 10, fps = 1 / h, dt = h, integrator = "rk4" }
    local p = scene:particle { mass = 1 }
    scene:channel("animals", { initial = { 2, 1 }, rate = function(_, _, u, v) return u * (1 - v), v * (u - 1) end })
    local rises, last = validation.crossings(1), nil
    validation.each(scene, h, steps, function(s, t)
      last = s:channel("animals", p)
      if t > 1 then rises(t, last[2] - 1, last[2] * (last[1] - 1)) end
    end)
    return { rises.times[1], invariant(last[1], last[2]) }
  end,
}
