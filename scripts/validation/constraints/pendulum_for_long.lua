-- A rigid pendulum swings by 150 degrees for a million steps of the finest level: the length that is left of 1 m, and the
-- largest error of the energy, which is that of a symplectic method, h^2 times a function of the state: it does not grow.
local validation = require("validation")

return validation.problem {
  title = "A large swing for a million steps",
  quantities = {
    { name = "length", unit = "m", reference = 1, source = "it is rigid", tolerance = 1e-10,
      why = "rounding of 1e-16, times a million at most", order = {}, noise = 1e-10 },
    { name = "energy error", unit = "J", reference = 0, scale = 1, source = "conservation",
      tolerance = 1e-6, why = "order 2: 2e-5 at the finest step, extrapolated to 0" },
  },
  time = { 0.02, 0.01, 0.005 },
  order = { time = 2 },
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-5 },
  solve = function(at)
    local duration = at.quick and 100 or 5000
    local scene = hooke.scene { duration = duration, fps = 5, dt = at.h, integrator = "leapfrog" }
    local anchor = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local phi = math.rad(150)
    local p = scene:particle { position = { math.sin(phi), 0, -math.cos(phi) }, mass = 1 }
    scene:pin { anchor }
    scene:force("gravity", { g = { 0, 0, -1 } })
    scene:constraint("bars", { edges = { { anchor, p } } })
    local first, worst, off = nil, 0, 0
    scene:on_frame(function(s)
      local energy, x = s:energy(), s:position(p)
      first = first or energy
      worst = math.max(worst, math.abs(energy - first))
      off = math.max(off, math.abs(math.sqrt(x[1] ^ 2 + x[2] ^ 2 + x[3] ^ 2) - 1))
    end)
    scene:run()
    return { 1 + off, worst }
  end,
}
