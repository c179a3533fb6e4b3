-- A motor, that is a resistance to other speeds than u within a bound, turns a flywheel: at first by the bound, u t/I, then w = u -
-- (u - w_1) exp(-c (t - t_1)/I).
local validation = require("validation")

local I, c, u, most, t = 0.6, 1.2, 6, 2.4, 1.5 -- kg m^2, N m s/rad, rad/s, N m, s
local function reference()
  local w = u - most / c
  return u - (u - w) * math.exp(-c * (t - w * I / most) / I)
end

return validation.problem {
  title = "A motor with a bound turns a flywheel",
  quantities = { { name = "speed", unit = "rad/s", reference = reference, source = "closed form of I w' = M(w)" } },
  time = { 0.1, 0.05, 0.025 },
  order = { time = 4, within = 0.6 },
  tolerance = 1e-6,
  why = "the corner of the torque, at 1 s, is the end of a step, errors of order 5 of a fast decay, beside those of order 4, are left",
  quick = { time = { 0.1, 0.05, 0.025 }, tolerance = 1e-5 },
  solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "rk4" }
    local wheel = scene:rigid { mass = 3, inertia = { 0.4, 0.4, I } }
    local axle = scene:joint { kind = "hinge", a = wheel, at = { 0, 0, 0 }, axis = { 0, 0, 1 } }
    scene:force("joint_drives", { points = { axle:frame() }, damping = c, speed = u, most = most })
    return axle:speed(scene:run():state())
  end,
}
