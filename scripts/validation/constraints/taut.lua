-- A bob falls beside its hook until the cable between them is taut: the velocity along the cable ends there, and the rest
-- swings the bob to the other side. With a the distance beside the hook the fall is sqrt(L^2 - a^2), a part a/L of its speed
-- is left, and it comes to rest where that is used up, g (z_top - z_taut) = v^2/2.
local validation = require("validation")

local g, L, a = 9.81, 1, 0.6
local fall = math.sqrt(L * L - a * a)
local time = math.sqrt(2 * fall / g) -- of the fall; steps are parts of it, so that one ends where the cable becomes taut
local left = g * time * a / L

return validation.problem {
  title = "A cable becomes taut",
  quantities = {
    { name = "height of the turning point", unit = "m", reference = left * left / (2 * g) - fall,
      source = "closed form: the velocity across the cable stays, energy is kept", scale = fall },
    { name = "largest length over L", reference = 1, source = "the cable does not stretch", tolerance = 1e-9, order = {},
      why = "of the projection" },
  },
  time = { time / 100, time / 200, time / 400 },
  order = { time = 1, within = 0.8 },
  tolerance = 1e-3,
  noise = 1e-5,
  why = "errors of order 1 at the impact",
  quick = { time = { time / 50, time / 100, time / 200 }, tolerance = 1e-2 },
  solve = function(at)
    local steps = math.floor(3 * time / at.h + 0.5)
    local scene = hooke.scene { duration = steps * at.h, fps = 1 / at.h, dt = at.h, integrator = "leapfrog" }
    local hook = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local bob = scene:particle { position = { a, 0, 0 }, mass = 1 }
    scene:pin { hook }
    scene:constraint("cables", { edges = { { hook, bob } }, length = L })
    scene:force("gravity", { g = { 0, 0, -g } })
    local longest, highest = 0, -math.huge
    validation.each(scene, at.h, steps, function(s)
      local x = s:position(bob)
      longest = math.max(longest, math.sqrt(x[1] * x[1] + x[2] * x[2] + x[3] * x[3]))
      if x[1] < 0 then highest = math.max(highest, x[3]) end
    end)
    return { highest, longest / L }
  end,
}
