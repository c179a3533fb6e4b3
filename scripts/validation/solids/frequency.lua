-- A bar with one end held swings lengthwise, after a push, in its first mode, sin(pi z/(2 L)), with the frequency
-- w = pi/2 sqrt(E/rho)/L and, by its viscosity, a part of critical damping D = damping w/(2 E), with which other modes, of
-- 3 w and more, die away 9 times as fast. With nu = 0 its cross-section does not matter.
local validation = require("validation")

local density, E, damping = 4, 4, 0.2
local w, D = math.pi / 2 * math.sqrt(E / density), damping * math.pi / (4 * math.sqrt(E * density))

return validation.problem {
  title = "First longitudinal mode of a solid bar",
  quantities = {
    { name = "period", unit = "s", reference = 2 * math.pi / (w * math.sqrt(1 - D * D)),
      source = "closed form, T = 4 L sqrt(rho/E)/sqrt(1 - D^2), L = 1 m" },
    { name = "decay", unit = "1/s", reference = w * D, source = "closed form, damping pi^2/(8 rho L^2)" },
  },
  space = { 4, 8, 16 },
  order = { space = 2 },
  tolerance = 1e-4,
  why = "the errors of order 2, 1e-3 at n = 16, leave those of order 4; the step, 1/200 s, adds some (w h)^2 = 6e-5",
  forces = { neo_hookean = { "tetrahedra", "E", "nu", "damping" } },
  quick = { space = { 2, 4, 8 }, tolerance = 5e-3 },
  solve = function(at)
    local n, h, duration = at.n, at.quick and 1 / 80 or 1 / 200, at.quick and 30 or 40
    local scene = hooke.scene { duration = duration, fps = validation.fps(h), dt = h, integrator = "leapfrog" }
    local bar = scene:block { nx = 2, ny = 2, nz = n + 1, size = { 1 / n, 1 / n, 1 }, density = density }
    scene:pin { bar:at(1, 1, 1), bar:at(2, 1, 1), bar:at(1, 2, 1), bar:at(2, 2, 1) }
    scene:force("neo_hookean", { tetrahedra = bar:tetrahedra(), E = E, nu = 0, damping = damping })
    scene:force("gravity", { g = { 0, 0, 1e-6 }, to = 1 })
    local rises, speeds, tip, before = validation.crossings(1), {}, bar:at(1, 1, n + 1), 0
    validation.each(scene, h, math.floor(duration / h + 0.5), function(s, t)
      local speed = s:velocity(tip)[3]
      if t > duration / 2 then
        rises(t, s:position(tip)[3] - 1, speed)
        local count = #rises.times
        if count > #speeds then speeds[count] = speed + (rises.times[count] - t) * (speed - before) / h end
      end
      before = speed
    end)
    local span, last = rises.times[#rises.times] - rises.times[1], #speeds
    return { span / (last - 1), math.log(speeds[1] / speeds[last]) / span }
  end,
}
