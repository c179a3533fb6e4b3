-- Van der Pol's oscillator x'' = mu (1 - x^2) x' - x runs into its limit cycle; period and amplitude there.
local numerics = require("numerics")
local validation = require("validation")

local mu, settled, x0 = 1, 30, 2

-- The cycle by extrapolation: from the section x' = 0, x > 0, until it comes back to itself.
local cycle
local function reference()
  if cycle then return cycle end
  local function f(_, y) return { y[2], mu * (1 - y[1] * y[1]) * y[2] - y[1] } end
  local top = { 2.0086, 0 }
  local period
  for _ = 1, 4 do
    local near = numerics.ode(f, 0, top, 6.5)
    period = 6.5 + numerics.root(function(t) return t == 0 and near[2] or numerics.ode(f, 0, near, t)[2] end, 0, 0.3)
    top = { numerics.ode(f, 0, near, period - 6.5)[1], 0 }
  end
  cycle = { period, top[1] }
  return cycle
end

local source = "recomputed by extrapolation (Gragg, Bulirsch and Stoer) to the fixed point of Poincare's map"

return validation.problem {
  title = "Van der Pol's limit cycle, mu = 1",
  quantities = {
    { name = "period", unit = "s", reference = function() return reference()[1] end, source = source },
    -- The error of the interpolation depends on where between two steps the top lies, so it shows no order.
    { name = "amplitude", unit = "m", reference = function() return reference()[2] end, source = source, order = {} },
  },
  time = { 0.05, 0.025, 0.0125 },
  order = { time = 4, within = 0.4 },
  tolerance = 1e-7,
  noise = 1e-11,
  why = "order 4, 1e-7 at the finest step, in the method and in the interpolation of the section",
  quick = { time = { 0.1, 0.05, 0.025 }, tolerance = 1e-5 },
  solve = function(at)
    local h, steps = at.h, math.ceil((settled + 15) / at.h)
    local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "rk4" }
    local p = scene:particle { position = { x0, 0, 0 }, mass = 1 }
    scene:force("field", { f = function(_, x, _, _, vx) return mu * (1 - x * x) * vx - x, 0, 0 end })
    local tops, falls, before = validation.crossings(-1), validation.crossings(-1), nil
    local amplitude
    validation.each(scene, h, steps, function(s, t)
      local x, v = s:position(p)[1], s:velocity(p)[1]
      if t > settled then
        falls(t, x, v)
        local count = tops(t, v, mu * (1 - x * x) * v - x)
        if count > 0 and not amplitude then
          amplitude = validation.cubic(tops.times[1], before.t, before.x, before.v, t, x, v)
        end
      end
      before = { t = t, x = x, v = v }
      return #falls.times == 2 and amplitude
    end)
    return { falls.times[2] - falls.times[1], amplitude }
  end,
}
