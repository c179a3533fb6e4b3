-- Energy, angular momentum and the direction of the pericentre (the vector of Laplace, Runge and Lenz) of Kepler's ellipse of
-- eccentricity 0.9 after ten periods, by gauss_radau: iterated to rounding, they are kept to it whatever the tolerance is.
local validation = require("validation")

local e, periods = 0.9, 10

return validation.problem {
  title = "What gauss_radau keeps of an eccentric orbit",
  quantities = {
    { name = "energy", unit = "J", reference = -0.5, source = "closed form, -1/2 of the semi-axis 1" },
    { name = "angular momentum", unit = "N m s", reference = math.sqrt(1 - e * e), source = "closed form, sqrt(1 - e^2)" },
    { name = "eccentricity, from the vector of Laplace", reference = e, source = "closed form" },
    { name = "angle of the pericentre", unit = "rad", reference = 0, scale = 1, source = "closed form: it stays" },
  },
  time = { 1e-8, 1e-9, 1e-10 },
  time_label = "tolerance",
  tolerance = 1e-11,
  noise = 1e-11,
  why = "rounding of some hundred steps, a hundredfold at the pericentre",
  forces = { central = { "strength", "power" } },
  quick = { time = { 1e-7, 1e-8, 1e-9 }, tolerance = 1e-10 },
  solve = function(at)
    local scene = hooke.scene { duration = 2 * math.pi * periods + 1, fps = 1, tol = at.h, integrator = "gauss_radau" }
    local p = scene:particle { position = { 1 - e, 0, 0 }, velocity = { 0, math.sqrt((1 + e) / (1 - e)), 0 }, mass = 1 }
    scene:force("central", { strength = 1, power = -2 })
    local s = scene:run():state()
    local x, v = s:position(p), s:velocity(p)
    local r, L = math.sqrt(x[1] ^ 2 + x[2] ^ 2), x[1] * v[2] - x[2] * v[1]
    local a, b = v[2] * L - x[1] / r, -v[1] * L - x[2] / r
    return { (v[1] ^ 2 + v[2] ^ 2) / 2 - 1 / r, L, math.sqrt(a * a + b * b), math.atan(b, a) }
  end,
}
