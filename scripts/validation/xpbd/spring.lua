-- One compliant constraint swings with w = 1/sqrt(alpha m), whatever the number of iterations: it is then a step of
-- backward Euler, whose period is longer by (w h)^2/3 and whose swing fades by w^2 h/2 a second.
local validation = require("validation")

local k, m = 1000, 1 -- alpha = 0.001 m/N
local w = math.sqrt(k / m)

return validation.problem {
  title = "Period and decay of one compliant constraint (XPBD)",
  quantities = {
    { name = "period", unit = "s", reference = 2 * math.pi / w, order = { time = 2 },
      source = "Macklin, Mueller and Chentanez 2016, alpha = 0.001: 0.198692 s" },
    { name = "rate of decay over h", unit = "1/s^2", reference = w * w / 2, order = { time = 2 }, tolerance = 2e-3,
      why = "order 2, 2 % at the finest step, and crossings are at discrete steps",
      source = "backward Euler: a step multiplies by 1/sqrt(1 + (w h)^2)" },
  },
  time = { 1 / 400, 1 / 800, 1 / 1600, 1 / 3200 },
  tolerance = 1e-5,
  why = "order 2, 3e-5 (w h)^2/3 at the finest step; (w h)^4/5 is left",
  quick = { time = { 1 / 400, 1 / 800, 1 / 1600 }, tolerance = 1e-2 },
  solve = function(at)
    local steps = math.floor(0.5 / at.h + 0.5)
    local scene = hooke.scene { duration = steps * at.h, fps = 1 / at.h, dt = at.h,
      integrator = { "xpbd", substeps = 1, iterations = 4 } }
    local pin = scene:particle { position = { 0, 0, 0 }, mass = m }
    local mass = scene:particle { position = { 1.5, 0, 0 }, mass = m }
    scene:pin { pin }
    scene:force("springs", { edges = { { pin, mass } }, k = k, rest = 1 })
    local zeros, speeds = validation.crossings(), {}
    validation.each(scene, at.h, steps, function(s, t)
      local x, v = s:position(mass)[1] - 1, s:velocity(mass)[1]
      zeros(t, x, v)
      speeds[#speeds + 1] = { t, x * x * w * w + v * v }
    end)
    local first, last = zeros.times[1], zeros.times[5]
    local a, b = speeds[1], speeds[#speeds]
    local rate = -math.log(b[2] / a[2]) / 2 / (b[1] - a[1])
    return { (last - first) / 2, rate / at.h }
  end,
}
