-- Foucault's pendulum, for small swings: x'' = -w^2 x + 2 W y', y'' = -w^2 y - 2 W x'. The plane of its swing turns with
-- -W; Coriolis' force is a magnetic one.
local validation = require("validation")

local w, W = 2 * math.pi, 0.1
local W0 = math.sqrt(w * w + W * W)
local turns = 5
local T = turns * 2 * math.pi / W0 -- whole swings: x + i y = exp(-i W t)(cos W0 t + i W/W0 sin W0 t)

return validation.problem {
  title = "Foucault's pendulum",
  quantities = {
    { name = "angle after five swings", unit = "rad", reference = -W * T, source = "closed form, -W t (Foucault 1851)" },
    { name = "size of the swing", unit = "m", reference = 1, order = { time = 4 },
      source = "closed form; the error in the swing's phase moves it across, where it counts squared" },
  },
  time = { T / 500, T / 1000, T / 2000 },
  order = { time = 2 },
  tolerance = 1e-4,
  why = "order 2, 1e-4 at the finest step",
  forces = { central = { "strength", "power" }, magnetic = { "B", "ratio" } },
  quick = { time = { T / 250, T / 500, T / 1000 }, tolerance = 1e-2 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 1 / T, dt = at.h, integrator = { "implicit_midpoint", tolerance = 1e-13 } }
    local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }
    scene:force("central", { strength = w * w, power = 1 })
    scene:force("magnetic", { B = { 0, 0, 2 * W }, ratio = 1 })
    local x = scene:run():state():position(p)
    return { math.atan(x[2], x[1]), math.sqrt(x[1] ^ 2 + x[2] ^ 2) }
  end,
}
