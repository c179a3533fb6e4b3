-- A pull -1/r^2 - delta/r^3 turns the ellipse: r = p/(1 + e cos kappa phi), kappa = sqrt(1 - delta/L^2). The angle between
-- two pericentres.
local validation = require("validation")

local delta, L = 0.05, math.sqrt(0.5 * 1.5) -- from the pericentre at r = 0.5, with Kepler's speed for e = 0.5

return validation.problem {
  title = "Precession by a pull of 1/r^3",
  quantities = {
    { name = "apsidal angle", unit = "rad", reference = 2 * math.pi / math.sqrt(1 - delta / L ^ 2),
      source = "closed form, 2 pi/sqrt(1 - delta/L^2) (Newton, Principia, I.44)" },
  },
  time = { 1 / 200, 1 / 400, 1 / 800 },
  order = { time = 2 },
  tolerance = 1e-8,
  why = "order 2, 1e-5 at the finest step, a thousandth of it extrapolated",
  forces = { central = { "strength", "power" } },
  quick = { time = { 1 / 50, 1 / 100, 1 / 200 }, tolerance = 1e-6 },
  solve = function(at)
    local h, steps = at.h, math.ceil(18 / at.h)
    local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "leapfrog" }
    local p = scene:particle { position = { 0.5, 0, 0 }, velocity = { 0, L / 0.5, 0 }, mass = 1 }
    scene:force("central", { strength = 1, power = -2 })
    scene:force("central", { strength = delta, power = -3 })
    local outward, before = validation.crossings(1), nil
    local angles = {}
    validation.each(scene, h, steps, function(s, t)
      local x, v = s:position(p), s:velocity(p)
      local r = math.sqrt(x[1] ^ 2 + x[2] ^ 2)
      local rate = (x[1] * v[1] + x[2] * v[2]) / r
      local now = { t = t, angle = math.atan(x[2], x[1]), turn = L / r ^ 2 }
      if t > 0 then -- rate' = L^2/r^3 - 1/r^2 - delta/r^3
        local count = outward(t, rate, (L * L - delta) / r ^ 3 - 1 / r ^ 2)
        if count > #angles then
          local when, b = outward.times[count], before
          angles[count] = validation.cubic(when, b.t, b.angle, b.turn, t, now.angle, now.turn)
        end
      end
      before = now
      return #angles == 3
    end)
    return (angles[3] - angles[1]) / 2 + 2 * math.pi
  end,
}
