-- A box on a hinge swings by two radians to either side: T = 4 K(sin 1) sqrt(I/(m g l)), with the moment of inertia I about
-- the hinge (Landau and Lifshitz, Mechanics, section 11).
local validation = require("validation")
local numerics = require("numerics")

local size, g, angle = { 0.4, 0.6, 1.2 }, 9.81, 2 -- m, m/s^2, rad
local l = size[3] / 2
local function reference()
  return 4 * numerics.ellipk(math.sin(angle / 2)) * math.sqrt(((size[1] ^ 2 + size[3] ^ 2) / 12 + l * l) / (g * l))
end

return validation.problem {
  title = "Compound pendulum on a hinge",
  quantities = { { name = "period", unit = "s", reference = reference,
    source = "elliptic integral (Landau and Lifshitz, Mechanics, 11)" } },
  time = { 0.01, 0.005, 0.0025 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "errors of order 2 leave those of order 4, (w h)^4 = 1e-8, times some tens at the turning points",
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-3 },
  solve = function(at)
    local steps = math.ceil(6 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local body = scene:rigid { shape = "box", size = size, density = 700, orientation = { 0, -angle, 0 },
      position = { l * math.sin(angle), 0, -l * math.cos(angle) } }
    scene:joint { kind = "hinge", a = body, at = { 0, 0, 0 }, axis = { 0, 1, 0 } }
    scene:force("gravity", { g = { 0, 0, -g } })
    local rises = validation.crossings(1)
    validation.each(scene, at.h, steps, function(s, t) rises(t, body:position(s)[1], body:velocity(s)[1]) end)
    return (rises.times[#rises.times] - rises.times[1]) / (#rises.times - 1)
  end,
}
