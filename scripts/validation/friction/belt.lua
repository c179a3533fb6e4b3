-- A parcel is put on a running belt: friction takes it along after u/(mu g), when it lies u^2/(2 mu g) behind.
local validation = require("validation")

local g, mu, u = 9.81, 0.25, 1.5
local slip = u / (mu * g)

return validation.problem {
  title = "A parcel on a running belt",
  quantities = {
    { name = "lag behind the belt", unit = "m", reference = u * u / (2 * mu * g), source = "Coulomb: u^2/(2 mu g)" },
    { name = "speed at half of the time that it slips", unit = "m/s", reference = u / 2, source = "Coulomb: mu g t" },
    { name = "speed at the end", unit = "m/s", reference = u, source = "it sticks" },
  },
  time = { 0.02, 0.01, 0.005 },
  tolerance = 1e-10,
  noise = 1e-10,
  why = "the acceleration is constant, and the step in which it ends is right",
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-10 },
  solve = function(at)
    local scene = hooke.scene { duration = 2 * slip, fps = 2 / slip, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:corrector("obstacle", { friction = mu, position = function(t) return u * t, 0, 0 end })
    local half = scene:run { to = slip / 2 }:state():velocity(p)[1]
    local s = scene:run():state()
    return { u * 2 * slip - s:position(p)[1], half, s:velocity(p)[1] }
  end,
}
