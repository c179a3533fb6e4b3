-- A link on an angle spring swings as a harmonic oscillator at any amplitude, here to 3.1 rad, almost folded.
local validation = require("validation")

local amplitude, swings = 3.1, 4

return validation.problem {
  title = "A link on an angle spring, to 3.1 rad",
  quantities = {
    { name = "period", unit = "s", reference = 2 * math.pi, source = "closed form, 2 pi sqrt(m l^2/k)" },
    { name = "x at t = 25 s", unit = "m", reference = math.cos(amplitude * math.cos(25)), scale = 1,
      source = "closed form, cos(3.1 cos t)" },
  },
  time = { 0.02, 0.01, 0.005, 0.0025 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "the errors of order 2, 1e-5 at the finest step, leave those of order 4",
  forces = { angle_springs = { "joints", "k", "rest" } },
  quick = { time = { 0.05, 0.025, 0.0125 }, tolerance = 1e-3 },
  solve = function(at)
    local h, T = at.h, 25
    local scene = hooke.scene { duration = T, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local wall = scene:particles { positions = { { -1, 0, 0 }, { 0, 0, 0 } }, mass = 1 }
    local x, z = math.cos(amplitude), math.sin(amplitude)
    local link = scene:particle { position = { x, 0, z }, mass = 1 }
    scene:pin(wall)
    scene:force("angle_springs", { joints = { { wall:at(1), wall:at(2), link } }, k = 1, rest = 0 })
    scene:constraint("bars", { edges = { { wall:at(2), link } } })
    local rises, last = validation.crossings(1), nil
    validation.each(scene, h, math.floor(T / h + 0.5), function(s, t)
      local p, v = s:position(link), s:velocity(link)
      rises(t, math.atan(p[3], p[1]), (p[1] * v[3] - p[3] * v[1]))
      last = p[1]
    end)
    return { (rises.times[swings] - rises.times[1]) / (swings - 1), last }
  end,
}
