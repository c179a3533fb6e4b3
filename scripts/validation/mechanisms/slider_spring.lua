-- A box on an inclined slider swings on the slider's spring: T = 2 pi sqrt(m/k), whatever the slope.
local validation = require("validation")

return validation.problem {
  title = "A box on the spring of a slider",
  quantities = { { name = "period", unit = "s", reference = 2 * math.pi * math.sqrt(2 / 50), source = "closed form" } },
  time = { 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "errors of order 2 leave those of order 4, (w h)^4/640 = 2e-7 at the middle step",
  quick = { time = { 0.08, 0.04, 0.02 }, tolerance = 1e-3 },
  solve = function(at)
    local steps = math.ceil(6 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local body = scene:rigid { shape = "box", size = { 0.2, 0.3, 0.4 }, mass = 2 }
    local rail = scene:joint { kind = "slider", a = body, at = { 0.1, 0, 0 }, axis = { 3, 0, -4 } }
    scene:force("joint_drives", { points = { rail:frame() }, of = "way", k = 50 })
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    local middle = 2 * 9.81 * 0.8 / 50 -- m, where it would rest
    local rises = validation.crossings(1)
    validation.each(scene, at.h, steps, function(s, t) rises(t, rail:way(s) - middle, rail:speed(s)) end)
    return (rises.times[#rises.times] - rises.times[1]) / (#rises.times - 1)
  end,
}
