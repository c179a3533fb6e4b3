-- Rolling friction rho, a length, slows a ball down by 5/7 rho g/r, spinning friction sigma its spin by 5/2 sigma g/r^2, until
-- both rest; on a slope of tan a below rho/r it stays.
local validation = require("validation")

local g, r, rho, sigma, v, w, t_end = 9.81, 0.1, 2e-3, 1e-3, 1, 6, 1
local slow, slower = 5 / 7 * rho * g / r, 5 / 2 * sigma * g / r ^ 2

local function ball(h, duration, slope, velocity, spin, kind)
  local scene = hooke.scene { duration = duration, fps = validation.fps(h), dt = h, integrator = "leapfrog" }
  local b = scene:rigid { shape = "sphere", radius = r, mass = 2, position = { 0, 0, r }, velocity = { velocity, 0, 0 },
    spin = { 0, velocity / r, spin } }
  b:surface { { 0, 0, 0 } }
  scene:force("gravity", { g = { g * math.sin(slope), 0, -g * math.cos(slope) } })
  if kind == "contact" then scene:body { shape = "box", size = { 6, 6, 0.2 }, position = { 0, 0, -0.1 } } end
  scene:corrector(kind or "obstacle", { friction = 0.5, radius = r, rolling = rho, spinning = sigma })
  local s = scene:run():state()
  return b:position(s)[1], b:velocity(s)[1], b:spin(s)[3]
end

local source = "closed form, a moment of rho times the normal force"

return validation.problem {
  title = "Rolling and spinning friction",
  quantities = {
    { name = "way", unit = "m", reference = v * t_end - slow * t_end ^ 2 / 2, source = source },
    { name = "speed", unit = "m/s", reference = v - slow * t_end, source = source },
    { name = "spin about the normal", unit = "rad/s", reference = w - slower * t_end, source = source },
    { name = "way to rest, alone", unit = "m", reference = 0.3 ^ 2 / (2 * slow), source = source },
    { name = "speed, contact", unit = "m/s", reference = v - slow * t_end, source = source },
    { name = "spin about the normal, contact", unit = "rad/s", reference = w - slower * t_end, source = source },
    { name = "creep, tan a = 0.99 rho/r", unit = "m", reference = 0, scale = 1, source = "it stays", tolerance = 1e-9, noise = 1e-9,
      why = "nothing moves, but for what a solution leaves in 1,000 steps" },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  tolerance = 2e-7,
  noise = 2e-7,
  why = "order 3, but for the steps in which it comes to rest",
  quick = { time = { 2e-2, 1e-2, 5e-3 }, tolerance = 1e-3 },
  solve = function(at)
    local x, speed, spin = ball(at.h, t_end, 0, v, w)
    local rest = ball(at.h, 3, 0, 0.3, 0)
    local creep = ball(at.h, 2, math.atan(0.99 * rho / r), 0, 0)
    local _, speed_c, spin_c = ball(at.h, t_end, 0, v, w, "contact")
    return { x, speed, spin, rest, speed_c, spin_c, creep }
  end,
}
