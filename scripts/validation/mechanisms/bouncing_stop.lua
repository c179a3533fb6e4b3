-- A weight on a vertical slider falls on a stop that gives back 0.8 of its speed: between impacts it is on parabolas, at the heights
-- e^(2 k) h (Newton's law of impact; Brogliato, Nonsmooth Mechanics, 1.2).
local validation = require("validation")

local g, e, depth, t = 9.81, 0.8, 0.2, 1.2
local function reference()
  local at, u = math.sqrt(2 * depth / g), math.sqrt(2 * depth * g)
  while at + 2 * e * u / g < t do at, u = at + 2 * e * u / g, e * u end
  return e * u * (t - at) - g * (t - at) ^ 2 / 2
end

return validation.problem {
  title = "A weight bounces on the stop of a slider",
  quantities = { { name = "height", unit = "m", reference = reference, scale = depth, source = "closed form", noise = 1e-9 } },
  time = { 0.02, 0.01, 0.005 },
  tolerance = 1e-12,
  why = "leapfrog has parabolas exactly, and impacts are found within steps",
  quick = { time = { 0.02, 0.01, 0.005 }, tolerance = 1e-8 },
  solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local body = scene:rigid { shape = "sphere", radius = 0.1, mass = 2 }
    local rail = scene:joint { kind = "slider", a = body, at = { 0, 0, 0 }, axis = { 0, 0, 1 } }
    scene:constraint("joint_stops", { points = { rail:frame() }, of = "way", lower = -depth, bounce = e })
    scene:force("gravity", { g = { 0, 0, -g } })
    return rail:way(scene:run():state()) + depth
  end,
}
