-- The pendulum as a differential-algebraic equation of index 3: x'' = -l x, y'' = -l y - 1, x^2 + y^2 = 1, from (1, 0) with
-- the velocity (0, 1); at t = 1. l is the force in its bar.
local validation = require("validation")

local source = "Hairer and Wanner, Solving ODEs II, here with the digits of elliptic functions"

return validation.problem {
  title = "Pendulum as a DAE of index 3",
  quantities = {
    { name = "x at t = 1 s", unit = "m", reference = 0.867348640600439322, source = source },
    { name = "y at t = 1 s", unit = "m", reference = 0.497701050479672929, source = source },
    { name = "vx at t = 1 s", unit = "m/s", reference = -0.0337480180609545196, source = source, scale = 1 },
    { name = "vy at t = 1 s", unit = "m/s", reference = 0.0588130114652500075, source = source, scale = 1 },
    { name = "multiplier at t = 1 s", unit = "N", reference = -0.493103151439018788, source = source },
  },
  time = { 1 / 100, 1 / 200, 1 / 400, 1 / 800 },
  together = true,
  order = { time = 2 },
  tolerance = 1e-9,
  why = "order 2 and even: what extrapolation leaves is of order 4, (h w)^4/100 = 1e-13, but the measured order is off by 1e-4",
  quick = { time = { 1 / 50, 1 / 100, 1 / 200 }, tolerance = 1e-6 },
  solve = function(at)
    local scene = hooke.scene { duration = 1, fps = 1, dt = at.h, integrator = "leapfrog" }
    local anchor = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local p = scene:particle { position = { 1, 0, 0 }, velocity = { 0, 1, 0 }, mass = 1 }
    scene:pin { anchor }
    scene:force("gravity", { g = { 0, -1, 0 } })
    scene:constraint("bars", { edges = { { anchor, p } } })
    local s = scene:run():state()
    local x, v = s:position(p), s:velocity(p)
    return { x[1], x[2], v[1], v[2], s:constraint_forces("bars")[1] }
  end,
}
