-- A block on a slope at 1.01 and 0.99 of the friction that holds it, tan a: it stays for ten seconds, or slides with g (sin
-- a - mu cos a).
local validation = require("validation")

local g, a, t_end = 9.81, 0.4, 10

local function block(part, h)
  local scene = hooke.scene { duration = t_end, fps = 10, dt = h, integrator = "leapfrog" }
  local b = scene:rigid { shape = "box", size = { 0.3, 0.2, 0.1 }, mass = 2, position = { 0, 0, 0.05 } }
  b:surface()
  scene:force("gravity", { g = { g * math.sin(a), 0, -g * math.cos(a) } })
  scene:corrector("obstacle", { friction = part * math.tan(a) })
  return b:position(scene:run():state())[1]
end

local slides = 0.01 * g * math.sin(a) * t_end ^ 2 / 2

return validation.problem {
  title = "A block on a slope at 1.01 and 0.99 of the critical friction",
  quantities = {
    { name = "creep in 10 s, mu = 1.01", unit = "m", reference = 0, scale = 1, source = "Coulomb: it sticks" },
    { name = "way in 10 s, mu = 0.99", unit = "m", reference = slides, source = "Coulomb: g (sin a - mu cos a) t^2/2" },
  },
  time = { 2e-2, 1e-2, 5e-3 },
  tolerance = 1e-11,
  noise = 1e-11,
  why = "the force is constant, so that every step is exact but for the rounding of 2,000",
  quick = { time = { 0.1, 0.05, 0.02 }, tolerance = 1e-8 },
  solve = function(at) return { block(1.01, at.h), block(0.99, at.h) } end,
}
