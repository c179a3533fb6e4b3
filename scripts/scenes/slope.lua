-- slope.lua: a card slides down a slope of tan = 1/2, a = g (tan - mu) cos, in the frame of the slope. What the barrier's
-- reach and the elastic slip of its friction cost in accuracy is seen with other values of them:
--   hooke bench slope.lua --integrators bdf2 --vary elastic_slip=1e-3,1e-4,5e-7 --metric way --until 0.1
local d_hat = param("d_hat", 1e-3, "gap at which the barrier begins, m", { min = 1e-6 })
local elastic_slip = param("elastic_slip", 5e-7, "displacement below which friction is less than Coulomb's, m", { min = 1e-12 })
local friction = param("friction", 0.4, "Coulomb's mu: above 1/2 the card stays", { min = 0 })
local g, cos, stiffness, density, T = 9.81, 1 / math.sqrt(1.25), 2000, 0.5, 0.5

local scene = hooke.scene { duration = T, fps = 60, integrator = "bdf2", dt = 1 / 240 }

-- It starts near the gap at which the barrier carries its weight.
local gap = d_hat * (1 - 0.5 * math.sqrt(density * g / (6 * stiffness)))
local card = scene:grid { nx = 5, ny = 4, width = 0.09, height = 0.06, density = density, origin = { 0, 0.011, gap } }
scene:force("springs", { edges = card:structural(), k = 2e3, damping = 1, label = "structural" })
scene:force("springs", { edges = card:shear(), k = 1e3, damping = 0.5, label = "shear" })
scene:pin(scene:mesh { vertices = { { -1, -1, 0 }, { 1, -1, 0 }, { 0, 1, 0 } }, faces = { { 1, 2, 3 } }, mass = 1 })

scene:force("gravity", { g = { 0.5 * g * cos, 0, -g * cos } })
scene:force("barrier", { d_hat = d_hat, elastic_slip = elastic_slip, friction = friction, stiffness = stiffness })
scene:measure("way", function(s) return s:position(card:at(3, 2))[1] - 0.045 end, { unit = "m" })
scene:measure("way by Coulomb", function(s)
  return g * cos * math.max(0, 0.5 - friction) * s.t ^ 2 / 2
end, { unit = "m" })
scene:output("table")
return scene
