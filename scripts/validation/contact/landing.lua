-- The order of an impact in time where forces change at it: a particle falls with drag, v' = -g - c v, and bounces on an
-- obstacle, in closed form but for the time of the impact, a root. A step that is divided at the landing evaluates forces
-- anew after it: order 2. One that is not (`divide = 0`, as where many land at once) takes them from the path before:
-- order 1, in proportion to the part of the step that the landing leaves. The levels have it in the middle of a step.
local validation = require("validation")
local numerics = require("numerics")

local g, c, H, e, m = 9.81, 3, 0.4, 0.8, 0.1

local function free(z, v, t)
  local part = (1 - math.exp(-c * t)) / c
  return z + (v + g / c) * part - g / c * t, (v + g / c) * math.exp(-c * t) - g / c
end

local hit = numerics.root(function(t) return (free(H, 0, t)) end, 0.1, 1)
local ends = 1.6 * hit

local function after()
  local _, v = free(H, 0, hit)
  return (free(0, -e * v, ends - hit))
end

local function landed(h, divide)
  local scene = hooke.scene { duration = ends, fps = 1 / ends, dt = h, integrator = "leapfrog" }
  local p = scene:particle { position = { 0, 0, H }, mass = m }
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:force("drag", { rate = c })
  scene:corrector("obstacle", { restitution = e, divide = divide })
  return scene:run():state():position(p)[3]
end

local source = "closed form, exponentials before and after the impact"

return validation.problem {
  title = "Order of an impact with drag",
  quantities = {
    { name = "height, the step divided", unit = "m", reference = after, order = { time = 2 }, source = source,
      tolerance = 1e-4, why = "the errors of order 2 leave those of order 3" },
    { name = "height, the step not divided", unit = "m", reference = after, order = { time = 1 }, source = source,
      tolerance = 1e-3, why = "the errors of order 1 leave those of order 2, (1/200)^2 times some tens" },
  },
  time = { hit / 22.5, hit / 67.5, hit / 202.5 }, -- 36, 108 and 324 steps
  quick = { time = { hit / 7.5, hit / 22.5, hit / 67.5 }, tolerance = 1e-2 },
  solve = function(at) return { landed(at.h, 4), landed(at.h, 0) } end,
}
