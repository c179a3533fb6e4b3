-- A mass on an obstacle under a spring slides back by itself, against friction: a cosine about the place where the spring
-- balances friction. The load is that of the weight, however many substeps a step has; and in free sliding, whose
-- speeds are exact, by so much.
local validation = require("validation")

local mu, g, w, mass, first = 0.35, 9.81, 7, 0.5, 0.3
local shift, ends = mu * g / w ^ 2, 0.4

local function slid(h, substeps, spring)
  local scene = hooke.scene { duration = ends, fps = 1 / ends, dt = h, integrator = { "xpbd", substeps = substeps } }
  local wall = scene:particle { position = { 1, 0, 0 }, mass = 1 }
  local p = scene:particle { position = { 0, 0, 0 }, velocity = { spring and 0 or 2, 0, 0 }, mass = mass }
  scene:pin { wall }
  scene:force("gravity", { g = { 0, 0, -g }, only = { p } })
  if spring then scene:force("springs", { edges = { { wall, p } }, k = mass * w ^ 2, rest = 1 - first }) end
  scene:corrector("obstacle", { friction = mu })
  return scene:run():state():position(p)[1]
end

local free = 2 * ends - mu * g * ends ^ 2 / 2
local drawn = first - shift - (first - shift) * math.cos(w * ends)

return validation.problem {
  title = "Friction on an obstacle by xpbd",
  quantities = {
    { name = "way of a mass that is thrown", unit = "m", reference = free, source = "Coulomb: v t - mu g t^2/2",
      tolerance = 1e-12, order = {}, noise = 1e-12, why = "speeds are exact in every step" },
    { name = "drawn by a spring, 10 substeps", unit = "m", reference = drawn, source = "closed form, a cosine" },
    { name = "drawn by a spring, 4 substeps", unit = "m", reference = drawn, source = "closed form, a cosine" },
  },
  time = { ends / 64, ends / 128, ends / 256 },
  order = { time = 1 },
  tolerance = 1e-3,
  why = "errors of order 1 leave those of order 2",
  quick = { time = { ends / 16, ends / 32, ends / 64 }, tolerance = 1e-2 },
  solve = function(at) return { slid(at.h, 10, false), slid(at.h, 10, true), slid(at.h, 4, true) } end,
}
