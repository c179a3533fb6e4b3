-- Two particles, and a particle and the middle of a free triangle, meet head on in free flight, by impulses: they part with
-- e times the speed, along the line between them, and momentum and angular momentum stay. The repulsion gives
-- restitution by its damping, which is told where masses are alike.
local validation = require("validation")
local methods = require("_methods")

local e, speed, radius, thin = 0.6, 2, 0.01, 1e-6 -- thin: what collides was not near before

-- The speed of separation over that before, and the change of momentum over m v.
local function two_particles(name, h)
  local scene = hooke.scene { duration = 0.1, fps = 10, dt = h, integrator = methods.integrator[name] }
  local a = scene:particle { position = { -0.05, 0, 0 }, velocity = { speed / 2, 0, 0 }, mass = 1 }
  local b = scene:particle { position = { 0.05, 0, 0 }, velocity = { -speed / 2, 0, 0 }, mass = 3 }
  methods.add(name, scene, { friction = 0, radius = radius, restitution = e, speed = speed, stiffness = 1e6 })
  local s = scene:run():state()
  local u, w = s:velocity(a)[1], s:velocity(b)[1]
  return (w - u) / speed, u + 3 * w + speed, s
end

local function particle_and_triangle(name, h, thickness, sweeps)
  local scene = hooke.scene { duration = 0.1, fps = 10, dt = h, integrator = "leapfrog" }
  local corners = { { 1, 0, 0 }, { -0.5, 0.8, 0 }, { -0.5, -0.8, 0 } }
  local sheet = scene:mesh { vertices = corners, faces = { { 1, 2, 3 } }, mass = 3 }
  local p = scene:particle { position = { 0, 0, 0.06 }, velocity = { 0, 0, -speed }, mass = 1 }
  methods.add(name, scene, { friction = 0.5, radius = thickness, restitution = e, sweeps = sweeps })
  local s, below, sum, turn = scene:run():state(), 0, 0, 0
  for k = 1, 3 do
    local x, v = s:position(sheet:at(k)), s:velocity(sheet:at(k))
    below, sum, turn = below + v[3] / 3, sum + v[3], turn + x[1] * v[3] - x[3] * v[1]
  end
  local x, v = s:position(p), s:velocity(p)
  return (v[3] - below) / speed, sum + v[3] + speed, turn + x[1] * v[3] - x[3] * v[1]
end

return validation.problem {
  title = "Head-on collisions",
  quantities = {
    { name = "restitution of two particles, impulses", reference = e, source = "Newton's law of impact" },
    { name = "their momentum", unit = "kg m/s", reference = 0, scale = 2, source = "conserved" },
    { name = "restitution of a particle and a triangle, impulses", reference = e, source = "Newton's law of impact" },
    { name = "their momentum along the normal", unit = "kg m/s", reference = 0, scale = 2, source = "conserved" },
    { name = "their angular momentum", unit = "kg m^2/s", reference = 0, scale = 2, source = "conserved" },
    { name = "momentum of two particles, repulsion", unit = "kg m/s", reference = 0, scale = 2, source = "conserved" },
    { name = "momentum of two particles, barrier", unit = "kg m/s", reference = 0, scale = 2, source = "conserved",
      tolerance = 1e-6, why = "the tolerance of the implicit steps" },
    { name = "restitution of two particles, repulsion", reference = e, tolerance = 0.2,
      source = "Hunt and Crossley 1975, to first order in 1 - e", why = "the formula is of first order in 1 - e = 0.4" },
    { name = "restitution of a particle and a triangle, impact zones", reference = e, source = "Newton's law of impact" },
    { name = "their momentum along the normal, impact zones", unit = "kg m/s", reference = 0, scale = 2, source = "conserved" },
    { name = "restitution in a rigid zone", reference = 0, scale = 1, source = "Bridson, Fedkiw and Anderson 2002, 7.3" },
    { name = "momentum along the normal, rigid zone", unit = "kg m/s", reference = 0, scale = 2, source = "conserved" },
    { name = "angular momentum, rigid zone", unit = "kg m^2/s", reference = 0, scale = 2, source = "conserved" },
  },
  time = { 1 / 400, 1 / 800, 1 / 1600 },
  noise = 0.01,
  tolerance = 1e-13,
  why = "rounding",
  quick = { time = { 1 / 100, 1 / 200, 1 / 400 } },
  solve = function(at)
    local e1, p1 = two_particles("impulses", at.h)
    local e2, p2, turn = particle_and_triangle("impulses", at.h, radius)
    local e3, p3 = two_particles("repulsion", at.h * methods.part.repulsion)
    local _, p4 = two_particles("barrier", at.h)
    local e5, p5 = particle_and_triangle("zones", at.h, thin)
    local e6, p6, turn6 = particle_and_triangle("zones", at.h, thin, 0)
    return { e1, p1, e2, p2, turn, p3, p4, e3, e5, p5, e6, p6, turn6 }
  end,
}
