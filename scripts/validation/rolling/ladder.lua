-- A ladder slides down a wall and along the floor without friction, and leaves the wall at 2/3 of the height of its upper
-- end. Its centre then keeps the speed along the floor that it has there.
local validation = require("validation")

local g, l, start = 9.81, 0.5, 1.2 -- m, half of its length; rad against the floor
local s = 2 / 3 * math.sin(start)
local speed = l * s * math.sqrt(3 / 2 * g / l * (math.sin(start) - s))

return validation.problem {
  title = "A ladder leaves the wall",
  quantities = {
    { name = "speed along the floor", unit = "m/s", reference = speed,
      source = "closed form: it leaves at sin a = 2/3 sin a_0" },
  },
  time = { 2e-3, 1e-3, 5e-4 },
  order = { time = 1 },
  tolerance = 3e-5,
  why = "contact of bodies that turn about what they touch has order 1; the wall's force ends at 0",
  quick = { time = { 8e-3, 4e-3, 2e-3 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = 0.6, fps = 5, dt = at.h, integrator = "leapfrog" }
    local x, z = math.cos(start), math.sin(start)
    local ends = { { 0, 0, 2 * l * z }, { 2 * l * x, 0, 0 } }
    local b = scene:rigid { points = { ends[1], { l * x, 0, l * z }, ends[2] }, masses = { 1, 4, 1 } }
    b:surface(ends)
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:corrector("obstacle", {})
    scene:corrector("obstacle", { normal = { 1, 0, 0 } })
    return b:velocity(scene:run():state())[1]
  end,
}
