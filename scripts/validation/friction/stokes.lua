-- A droplet falls through air with Stokes' drag: vt (1 - exp(-t/tau)), tau = m/(6 pi eta r).
local validation = require("validation")

local g, eta, r, density = 9.81, 1.8e-5, 2e-5, 1000
local m = 4 / 3 * math.pi * r ^ 3 * density
local tau = m / (6 * math.pi * eta * r)
local t_end = 3 * tau

return validation.problem {
  title = "A droplet sinks: Stokes' law",
  quantities = {
    { name = "speed after 3 tau", unit = "m/s", reference = g * tau * (1 - math.exp(-3)),
      source = "Stokes 1851: m/(6 pi eta r) g (1 - exp(-t/tau))" },
    { name = "way after 3 tau", unit = "m", reference = g * tau * tau * (3 - 1 + math.exp(-3)),
      source = "closed form, its integral" },
  },
  time = { tau / 10, tau / 20, tau / 40 },
  order = { time = 4 },
  tolerance = 1e-8,
  why = "order 4, (h/tau)^4/120 = 3e-9 at the finest step",
  forces = { drag = { "viscosity", "radius" } },
  quick = { time = { tau / 10, tau / 20, tau / 40 }, tolerance = 1e-7 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 1 / tau, dt = at.h, integrator = "rk4" }
    local p = scene:particle { position = { 0, 0, 0 }, mass = m }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:force("drag", { viscosity = eta, radius = r })
    local s = scene:run():state()
    return { -s:velocity(p)[3], -s:position(p)[3] }
  end,
}
