-- A top on a ball joint, started at the rate at which its axis goes round at one angle, p = (C w - sqrt(C^2 w^2 -
-- 4 A m g l cos a))/(2 A cos a), with A and C its moments of inertia about the joint and w its spin about the axis: the
-- slow one of the two regular precessions (Goldstein, Classical Mechanics, 5.7).
local validation = require("validation")
local bodies = require("_bodies")

local m, l, g, C, w, angle, t = 1, 0.5, 9.81, 0.1, 60, 0.5, 3 -- kg, m, m/s^2, kg m^2, rad/s, rad, s
local across = 0.2 -- kg m^2, about the centre of mass
local A = across + m * l * l
local rate = (C * w - math.sqrt((C * w) ^ 2 - 4 * A * m * g * l * math.cos(angle))) / (2 * A * math.cos(angle))

return validation.problem {
  title = "A top precesses regularly",
  quantities = {
    { name = "rate of precession", unit = "rad/s", reference = rate, source = "closed form (Goldstein, Classical Mechanics, 5.7)" },
    { name = "largest change of the angle", unit = "rad", reference = 0, scale = angle, source = "closed form" },
  },
  time = { 0.004, 0.002, 0.001 },
  order = { time = 2 },
  tolerance = 3e-6,
  why = "errors of order 2 leave those of order 4: (w h)^4 = 1.3e-5 for the spin, of which the axis sees a part",
  quick = { time = { 0.01, 0.005, 0.0025 }, tolerance = 1e-3 },
  solve = function(at)
    local steps = math.floor(t / at.h + 0.5)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local up = { math.sin(angle), 0, math.cos(angle) }
    local about = w - rate * math.cos(angle) -- the spin is rate e_z + about e_axis
    scene:force("gravity", { g = { 0, 0, -g } })
    local body = scene:rigid { mass = m, inertia = { across, across, C }, orientation = { 0, angle, 0 },
      position = { l * up[1], 0, l * up[3] }, spin = { about * up[1], 0, about * up[3] + rate },
      velocity = { 0, rate * l * up[1], 0 } }
    scene:joint { kind = "ball", a = body, at = { 0, 0, 0 } }
    local turned, before, largest = 0, 0, 0
    validation.each(scene, at.h, steps, function(s)
      local R = bodies.rows(body, s)
      local now = math.atan(R[2][3], R[1][3])
      turned, before = turned + (now - before + math.pi) % (2 * math.pi) - math.pi, now
      largest = math.max(largest, math.abs(math.acos(R[3][3]) - angle))
    end)
    return { turned / t, largest }
  end,
}
