-- A ball on a slope rolls with 5/7 g sin a where mu is above 2/7 tan a, and slips with g (sin a - mu cos a) below, turning
-- with 5/2 mu g cos a/r.
local validation = require("validation")

local g, a, r, t_end = 9.81, 0.5, 0.1, 1
local critical = 2 / 7 * math.tan(a)

local function ball(mu, h)
  local scene = hooke.scene { duration = t_end, fps = validation.fps(h), dt = h, integrator = "leapfrog" }
  local b = scene:rigid { shape = "sphere", radius = r, mass = 2, position = { 0, 0, r } }
  b:surface { { 0, 0, 0 } }
  scene:force("gravity", { g = { g * math.sin(a), 0, -g * math.cos(a) } })
  scene:corrector("obstacle", { friction = mu, radius = r })
  local s = scene:run():state()
  return b:velocity(s)[1], r * b:spin(s)[2]
end

local function slips(mu) return g * (math.sin(a) - mu * math.cos(a)) * t_end, 5 / 2 * mu * g * math.cos(a) * t_end end
local slow, turned = slips(0.99 * critical)
local source = "closed form, critical friction 2/7 tan a"

return validation.problem {
  title = "A ball on a slope at 0.99 and 1.01 of the critical friction",
  quantities = {
    { name = "speed, mu = 1.01", unit = "m/s", reference = 5 / 7 * g * math.sin(a) * t_end, source = source },
    { name = "r w, mu = 1.01", unit = "m/s", reference = 5 / 7 * g * math.sin(a) * t_end, source = source },
    { name = "speed, mu = 0.99", unit = "m/s", reference = slow, source = source },
    { name = "r w, mu = 0.99", unit = "m/s", reference = turned, source = source },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  tolerance = 1e-11,
  noise = 1e-11,
  why = "forces are constant, so that steps are exact but for the rotation of the four particles by large angles",
  quick = { time = { 2e-2, 1e-2, 5e-3 }, tolerance = 1e-6 },
  solve = function(at)
    local v, w = ball(1.01 * critical, at.h)
    local v_slow, w_slow = ball(0.99 * critical, at.h)
    return { v, w, v_slow, w_slow }
  end,
}
