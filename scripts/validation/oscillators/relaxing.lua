-- A mass on a spring with a Maxwell branch beside it, thrown at 1 m/s: x'' = -k x - m, m' = k_m x' - m/tau. The numbers are
-- those whose roots are -a and -b +- i w, by (s^2 + k)(s + 1/tau) + k_m s = (s + a)((s + b)^2 + w^2).
local validation = require("validation")

local a, b, w, t_end = 2, 1, 5, 1.5
local tau = 1 / (a + 2 * b)
local k = a * (b * b + w * w) * tau
local k_m = 2 * a * b + b * b + w * w - k

-- x(0) = 0, x'(0) = 1, x''(0) = 0
local A = 2 * b / ((a - b) ^ 2 + w * w)
local C = (1 + A * (a - b)) / w
local function exact(t) return A * math.exp(-a * t) + math.exp(-b * t) * (C * math.sin(w * t) - A * math.cos(w * t)) end

return validation.problem {
  title = "Mass on a spring that relaxes",
  quantities = {
    { name = "x at t = 1.5 s", unit = "m", reference = exact(t_end), scale = math.exp(-b * t_end) / w,
      source = "closed form, the standard linear solid" },
  },
  time = { 0.02, 0.01, 0.005, 0.0025 },
  order = { time = 4 },
  tolerance = 1e-8,
  why = "1e-6 of the coarsest step falls by 16 at every halving, and extrapolation leaves a hundredth of the last",
  forces = { maxwell_springs = { "edges", "k", "k_m", "tau" } },
  quick = { time = { 0.06, 0.03, 0.015 }, tolerance = 1e-5 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 2 / t_end, dt = at.h, integrator = "rk4" }
    local anchor = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local p = scene:particle { position = { 1, 0, 0 }, velocity = { 1, 0, 0 }, mass = 1 }
    scene:pin { anchor }
    scene:force("maxwell_springs", { edges = { { anchor, p } }, k = k, k_m = k_m, tau = tau })
    return scene:run():state():position(p)[1] - 1
  end,
}
