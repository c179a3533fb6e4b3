-- A damped oscillator lets go: x'' = -w^2 x - 2 d x', x(0) = 1, x'(0) = 0.
local validation = require("validation")

local w, d, t_end = 2 * math.pi, 0.5, 2.25

local function exact(t)
  local wd = math.sqrt(w * w - d * d)
  return math.exp(-d * t) * (math.cos(wd * t) + d / wd * math.sin(wd * t))
end

return validation.problem {
  title = "Damped oscillator",
  quantities = {
    { name = "x at t = 2.25 s", unit = "m", reference = exact(t_end),
      scale = math.exp(-d * t_end),
      source = "closed form, exp(-d t)(cos wd t + d/wd sin wd t)" },
  },
  time = { 0.01, 0.005, 0.0025, 0.00125 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "(w h)^2/24 w t = 4e-5 at the finest step, of which a term of order 3 leaves one or two percent",
  forces = { central = { "strength", "power" }, drag = { "rate" } },
  quick = { time = { 0.03, 0.015, 0.0075 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 4, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }
    scene:force("central", { strength = w * w, power = 1 })
    scene:force("drag", { rate = 2 * d })
    return scene:run():state():position(p)[1]
  end,
}
