-- Two masses fly apart until the rope between them comes taut, 1.1 m long, and then go on together: an inelastic impact
-- that keeps the momentum. The velocity is that of the centre of mass at any step; the places are off by the part of
-- a step for which the rope was too long, which the correction takes back, and by none on average: exact as well.
local validation = require("validation")

local m1, m2, v1, v2, T = 1, 3, -0.5, 1.7, 1
local V = (m1 * v1 + m2 * v2) / (m1 + m2)
local middle = m2 * 0.5 / (m1 + m2) + V * T -- from masses at 0 and 0.5 m

return validation.problem {
  title = "A rope comes taut between two masses",
  quantities = {
    { name = "velocity of the lighter", unit = "m/s", reference = V, source = "momentum: (m1 v1 + m2 v2)/(m1 + m2)" },
    { name = "velocity of the heavier", unit = "m/s", reference = V, source = "momentum: (m1 v1 + m2 v2)/(m1 + m2)" },
    { name = "place of the lighter", unit = "m", reference = middle - m2 * 1.1 / (m1 + m2),
      source = "the centre of mass, and the length of the rope" },
    { name = "place of the heavier", unit = "m", reference = middle + m1 * 1.1 / (m1 + m2),
      source = "the centre of mass, and the length of the rope" },
  },
  time = { 1 / 30, 1 / 70, 1 / 150 },
  noise = 1e-12,
  tolerance = 1e-12,
  why = "rounding of 150 steps",
  quick = { time = { 1 / 30, 1 / 70, 1 / 150 }, tolerance = 1e-12 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 10, dt = at.h, integrator = "symplectic_euler" }
    local a = scene:particle { position = { 0, 0, 0 }, velocity = { v1, 0, 0 }, mass = m1 }
    local b = scene:particle { position = { 0.5, 0, 0 }, velocity = { v2, 0, 0 }, mass = m2 }
    scene:corrector("strain_limit", { edges = { { a, b } }, rest = 1, limit = 0.1, tolerance = 0 })
    local s = scene:run():state()
    return { s:velocity(a)[1], s:velocity(b)[1], s:position(a)[1], s:position(b)[1] }
  end,
}
