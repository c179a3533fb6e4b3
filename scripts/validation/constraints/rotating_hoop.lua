-- A bead on an upright hoop that turns about its vertical diameter at the rate w: above w^2 = g/R the bottom is no place to
-- rest, and the bead swings about the angle with cos = g/(w^2 R). In u = cos (angle from the bottom) the motion is
-- du/dt = w sqrt((1 - u^2)(u - u1)(u2 - u)), u1 + u2 = 2 g/(w^2 R). The hoop is a sphere and a plane that turns: two
-- functions, one of time; it does work on the bead.
local validation = require("validation")
local numerics = require("numerics")

local g, w, start = 9.81, 4, 0.5 -- R = 1
local u2 = math.cos(start)
local u1 = 2 * g / (w * w) - u2

local function period()
  return 2 / w * numerics.integrate(function(p)
    local u = (u1 + u2) / 2 - (u2 - u1) / 2 * math.cos(p)
    return 1 / math.sqrt(1 - u * u)
  end, 0, math.pi)
end

return validation.problem {
  title = "Bead on a rotating hoop",
  quantities = {
    { name = "period of the swing", unit = "s", reference = period,
      source = "energy in the turning frame, quadrature (Goldstein, Classical Mechanics, ch. 2)" },
  },
  time = { 0.01, 0.005, 0.0025, 0.00125 },
  order = { time = 2 },
  tolerance = 1e-8,
  why = "errors of order 2 leave those of order 4: (w h)^4 = 2e-10 at the finest step, times some tens for harmonics",
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-2 },
  solve = function(at)
    local steps = math.ceil(4.8 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { math.sin(start), 0, -math.cos(start) }, mass = 0.5,
      velocity = { 0, w * math.sin(start), 0 } }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:constraint("surface", { particles = { p },
      g = function(_, x, y, z) return (x * x + y * y + z * z - 1) / 2 end,
      g_gradient = function(_, x, y, z) return x, y, z end,
      h = function(t, x, y) return y * math.cos(w * t) - x * math.sin(w * t) end,
      h_gradient = function(t) return -math.sin(w * t), math.cos(w * t), 0 end })
    local rises = validation.crossings(1)
    validation.each(scene, at.h, steps, function(s, t) rises(t, s:position(p)[3] + (u1 + u2) / 2, s:velocity(p)[3]) end)
    return (rises.times[#rises.times] - rises.times[1]) / (#rises.times - 1)
  end,
}
