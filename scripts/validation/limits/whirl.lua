-- A mass whirls about a pin on a rope that may be drawn out by a tenth, and is: it keeps its speed, on a circle of 1.1 m.
-- Corrections that lost angular momentum would slow it down in every step.
local validation = require("validation")

local R, v, T = 1.1, 3, 2

return validation.problem {
  title = "A mass whirls at the limit of its rope",
  quantities = {
    { name = "speed", unit = "m/s", reference = v, source = "closed form: no force along the path" },
    { name = "x", unit = "m", reference = R * math.cos(v * T / R), source = "closed form, a uniform motion on a circle" },
    { name = "y", unit = "m", reference = R * math.sin(v * T / R), source = "closed form, a uniform motion on a circle" },
  },
  time = { 1 / 50, 1 / 100, 1 / 200 },
  order = { time = 2 },
  noise = 1e-12,
  tolerance = 1e-5,
  why = "order 2, an angle of 5.5 (v h/R)^2/3; its square is left, 2e-8, and half of it in the second order's own change",
  quick = { time = { 1 / 25, 1 / 50, 1 / 100 }, tolerance = 1e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 5, dt = at.h, integrator = "leapfrog" }
    local pin = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local mass = scene:particle { position = { R, 0, 0 }, velocity = { 0, v, 0 }, mass = 2 }
    scene:pin { pin }
    scene:corrector("strain_limit", { edges = { { pin, mass } }, rest = 1, limit = 0.1, tolerance = 0 })
    local s = scene:run():state()
    local x, u = s:position(mass), s:velocity(mass)
    return { math.sqrt(u[1] ^ 2 + u[2] ^ 2), x[1], x[2] }
  end,
}
