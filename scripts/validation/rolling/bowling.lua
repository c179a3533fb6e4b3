-- A bowling ball that slides first and then rolls, on an obstacle and on a floor of triangles: friction mu m g slows it down
-- and turns it until 5/7 of its speed are left, at the time 2 v/(7 mu g).
local validation = require("validation")

local g, mu, v, r, t_end = 9.81, 0.2, 1, 0.1, 1
local t_roll = 2 * v / (7 * mu * g)
local way = v * t_roll - mu * g * t_roll ^ 2 / 2 + 5 / 7 * v * (t_end - t_roll)

local function ball(h, kind)
  local scene = hooke.scene { duration = t_end, fps = validation.fps(h), dt = h, integrator = "leapfrog" }
  local b = scene:rigid { shape = "sphere", radius = r, mass = 6, position = { 0, 0, r }, velocity = { v, 0, 0 } }
  b:surface { { 0, 0, 0 } }
  scene:force("gravity", { g = { 0, 0, -g } })
  if kind == "contact" then
    scene:body { shape = "box", size = { 6, 6, 0.2 }, position = { 0, 0, -0.1 } }
    scene:corrector("contact", { radius = r, friction = mu })
  else
    scene:corrector("obstacle", { radius = r, friction = mu })
  end
  local s = scene:run():state()
  return b:velocity(s)[1], b:position(s)[1], r * b:spin(s)[2] / b:velocity(s)[1]
end

local source = "closed form (Coriolis 1835, Theorie mathematique des effets du jeu de billard)"

return validation.problem {
  title = "A bowling ball: first it slides, then it rolls",
  quantities = {
    { name = "speed, obstacle", unit = "m/s", reference = 5 / 7 * v, source = source, tolerance = 1e-12,
      noise = 1e-12, why = "momentum about a line of the floor is kept, whatever rubs" },
    { name = "way, obstacle", unit = "m", reference = way, source = source },
    { name = "r w/v, obstacle", reference = 1, source = "rolling without slipping", tolerance = 1e-12,
      noise = 1e-12, why = "momentum about a line of the floor is kept, whatever rubs" },
    { name = "speed, contact", unit = "m/s", reference = 5 / 7 * v, source = source, tolerance = 1e-12,
      noise = 1e-12, why = "momentum about a line of the floor is kept, whatever rubs" },
    { name = "way, contact", unit = "m", reference = way, source = source },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  tolerance = 1e-6,
  noise = 1e-6,
  why = "steps of order 3, but for the one in which it begins to roll: (mu g h)^2/v = 4e-6 of a step",
  quick = { time = { 1e-2, 5e-3, 2.5e-3 }, tolerance = 1e-5 },
  solve = function(at)
    local speed, x, slip = ball(at.h, "obstacle")
    local speed_c, x_c = ball(at.h, "contact")
    return { speed, x, slip, speed_c, x_c }
  end,
}
