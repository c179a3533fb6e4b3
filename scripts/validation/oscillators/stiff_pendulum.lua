-- A pendulum on a spring of 1e6 N/m falls from the horizontal; 10 s later. Its ringing, of 1000 rad/s, is small and has
-- to be resolved all the same.
local validation = require("validation")

local source = "stiffpendul of BiMD (Brugnano and Magherini), recomputed with 113 bits"

return validation.problem {
  title = "Stiff spring pendulum, k = 1e6 N/m",
  quantities = {
    { name = "x at t = 10 s", unit = "m", reference = -0.81157637265109929, source = source },
    { name = "y at t = 10 s", unit = "m", reference = -0.58424934474571282, source = source },
    { name = "vx at t = 10 s", unit = "m/s", reference = -0.63155263059074722, source = source },
    { name = "vy at t = 10 s", unit = "m/s", reference = 0.87728951446538580, source = source },
  },
  time = { 1 / 1000, 1 / 2000, 1 / 4000 },
  together = true,
  order = { time = 2 },
  tolerance = 1e-8,
  why = "order 2, 1e-7 at the finest step, of which extrapolation leaves a hundredth",
  forces = { springs = { "edges", "k" } },
  quick = { time = { 1 / 800, 1 / 1600, 1 / 3200 }, tolerance = 1e-7 },
  solve = function(at)
    local scene = hooke.scene { duration = 10, fps = 20, dt = at.h, integrator = "leapfrog" }
    local anchor = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }
    scene:pin { anchor }
    scene:force("gravity", { g = { 0, -1, 0 } })
    scene:force("springs", { edges = { { anchor, p } }, k = 1e6 })
    local s = scene:run():state()
    local x, v = s:position(p), s:velocity(p)
    return { x[1], x[2], v[1], v[2] }
  end,
}
