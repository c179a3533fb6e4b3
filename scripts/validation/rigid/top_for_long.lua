-- Lagrange's top for some hundred nutations by kahan_li8: the error of its energy is of order 8 and does not grow.
local validation = require("validation")

return validation.problem {
  title = "Energy of Lagrange's top for long, by kahan_li8",
  quantities = {
    { name = "change of the energy", unit = "J", reference = 0, scale = 1, source = "conservation", tolerance = 1e-8,
      why = "order 8, and rounding of 1e-14 in 1e5 stages", order = { time = 8, within = 1 }, noise = 1e-12 },
  },
  time = { 0.02, 0.01, 0.005 },
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-6 },
  solve = function(at)
    local scene = hooke.scene { duration = at.quick and 4 or 40, fps = 25, dt = at.h, integrator = "kahan_li8" }
    local up = { math.sin(0.5), 0, math.cos(0.5) }
    local body = scene:rigid { mass = 1, inertia = { 0.2, 0.2, 0.1 }, orientation = { 0, 0.5, 0 },
      position = { 0.5 * up[1], 0, 0.5 * up[3] },
      spin = { 40 * up[1], 0, 40 * up[3] } }
    scene:joint { kind = "ball", a = body, at = { 0, 0, 0 } }
    scene:force("gravity", { g = { 0, 0, -9.81 } })
    local first, worst = nil, 0
    scene:on_frame(function(s)
      first = first or s:energy()
      worst = math.max(worst, math.abs(s:energy() - first))
    end)
    scene:run()
    return worst
  end,
}
