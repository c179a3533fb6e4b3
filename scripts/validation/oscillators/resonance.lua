-- A damped oscillator in its steady state, shaken below, at and above its own frequency: amplitude and phase lag.
local validation = require("validation")

local w0, d, strength = 2 * math.pi, 1.0, 1.0 -- x'' = -w0^2 x - 2 d x' + strength cos w t
local ratios = { 0.5, 1, 1.5 }

local quantities = {}
for i, ratio in ipairs(ratios) do
  local w = ratio * w0
  local source = "closed form, 1/(w0^2 - w^2 + 2 i d w)"
  quantities[2 * i - 1] = { name = ("amplitude at w = %g w0"):format(ratio), unit = "m", source = source,
    reference = strength / math.sqrt((w0 * w0 - w * w) ^ 2 + (2 * d * w) ^ 2) }
  quantities[2 * i] = { name = ("phase lag at w = %g w0"):format(ratio), unit = "rad", source = source,
    reference = math.atan(2 * d * w, w0 * w0 - w * w) }
end

return validation.problem {
  title = "Driven, damped oscillator: resonance",
  quantities = quantities,
  time = { 1 / 40, 1 / 80, 1 / 160 },
  order = { time = 2 },
  tolerance = 1e-4,
  why = "order 2, 1e-3 at the finest step; extrapolation leaves the order 4, about its square",
  forces = { central = { "strength", "power" }, drag = { "rate" } },
  quick = { time = { 1 / 20, 1 / 40, 1 / 80 }, tolerance = 1e-2 },
  solve = function(at)
    local found = {}
    for i, ratio in ipairs(ratios) do
      -- 20 s leave exp(-20) = 2e-9 of the start, which begins in the steady state but for the method's error.
      local w, whole, steps = ratio * w0, math.floor(20 / at.h + 0.5), math.floor(2 / at.h + 0.5)
      local scene = hooke.scene { duration = 22, fps = 1 / at.h, dt = at.h, integrator = "leapfrog" }
      local a, lag = quantities[2 * i - 1].reference, quantities[2 * i].reference
      local p = scene:particle { position = { a * math.cos(lag), 0, 0 }, velocity = { a * w * math.sin(lag), 0, 0 },
        mass = 1 }
      scene:force("central", { strength = w0 * w0, power = 1 })
      scene:force("drag", { rate = 2 * d })
      scene:force("gravity", { g = function(t) return strength * math.cos(w * t), 0, 0 end })
      local c, s = 0, 0 -- Fourier sums over the last 2 s, whole periods of all three
      for k = 0, whole + steps - 1 do
        local x = scene:run { to = k * at.h }:state():position(p)[1]
        if k >= whole then
          c, s = c + x * math.cos(w * k * at.h), s + x * math.sin(w * k * at.h)
        end
      end
      found[2 * i - 1], found[2 * i] = 2 / steps * math.sqrt(c * c + s * s), math.atan(s, c)
    end
    return found
  end,
}
