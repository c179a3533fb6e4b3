-- A block slides on a floor until friction has stopped it: v^2/(2 mu g), after v/(mu g).
local validation = require("validation")

local g, mu, v = 9.81, 0.35, 2

return validation.problem {
  title = "Stopping distance on a floor",
  quantities = {
    { name = "distance", unit = "m", reference = v * v / (2 * mu * g), source = "Coulomb: v^2/(2 mu g)" },
    { name = "speed halfway in time", unit = "m/s", reference = v / 2, source = "Coulomb: v - mu g t" },
  },
  time = { 0.02, 0.01, 0.005 },
  tolerance = 1e-11,
  noise = 1e-11,
  why = "the deceleration is constant, and the step in which it ends is right",
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-11 },
  solve = function(at)
    local half = v / (2 * mu * g)
    local scene = hooke.scene { duration = 4 * half, fps = 1 / half, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { 0, 0, 0 }, velocity = { v, 0, 0 }, mass = 1 }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:corrector("obstacle", { friction = mu })
    local speed = scene:run { to = half }:state():velocity(p)[1]
    return { scene:run():state():position(p)[1], speed }
  end,
}
