-- Two soft spheres meet head on: they part with e times the speed.
local validation = require("validation")

local r, m, k, e, speed = 0.05, 0.1, 1e4, 0.6, 2
local half = m / 2 -- reduced mass
local contact = math.pi / math.sqrt(k / half) -- about

return validation.problem {
  title = "Two soft spheres collide",
  quantities = {
    { name = "speed after over before", reference = e, source = "closed form, linear spring and dashpot (Schwager and Poeschel 2007)" },
  },
  time = { contact / 100, contact / 200, contact / 400, contact / 800 },
  order = { time = 1 },
  tolerance = 1e-4,
  why = "order 1, since the dashpot acts at once when they meet",
  quick = { time = { contact / 100, contact / 200, contact / 400 }, tolerance = 1e-2 },
  solve = function(at)
    local scene = hooke.scene { duration = 3 * contact, fps = 1 / contact, dt = at.h, integrator = "leapfrog" }
    local a = scene:particle { position = { -r, 0, 0 }, velocity = { speed / 2, 0, 0 }, mass = m }
    local b = scene:particle { position = { r, 0, 0 }, velocity = { -speed / 2, 0, 0 }, mass = m }
    scene:force("soft_spheres", { radius = r, stiffness = k, restitution = e, friction = 0 })
    local s = scene:run():state()
    return (s:velocity(b)[1] - s:velocity(a)[1]) / speed
  end,
}
