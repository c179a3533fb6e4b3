-- Periods of a rigid pendulum of L = g = 1 swinging by 10 to 179 degrees to each side: 4 K(sin(angle/2)).
local validation = require("validation")
local numerics = require("numerics")

local angles, quantities = { 10, 45, 90, 150, 179 }, {}
for k, angle in ipairs(angles) do
  quantities[k] = { name = ("period at %d degrees"):format(angle), unit = "s",
    reference = function() return 4 * numerics.ellipk(math.sin(math.rad(angle / 2))) end, source = "closed form, 4 K(sin(angle/2))" }
end
-- Near the top the error grows as e^t from one side to the other, and with it the terms of order 4.
quantities[5].tolerance, quantities[5].why = 1e-6, "the motion near the top, exp(5) times slower, multiplies errors of order 4"

return validation.problem {
  title = "Periods of large swings",
  quantities = quantities,
  time = { 1 / 50, 1 / 100, 1 / 200, 1 / 400 },
  order = { time = 2 },
  tolerance = 1e-8,
  why = "order 2, h^2/24 = 3e-7 at the finest step; extrapolation leaves (h w)^4 of some 1 rad/s, 1e-10, and interpolation",
  quick = { time = { 1 / 25, 1 / 50, 1 / 100 }, tolerance = 1e-2 },
  solve = function(at)
    local got = {}
    for k, angle in ipairs(angles) do
      local T = 4 * numerics.ellipk(math.sin(math.rad(angle / 2)))
      local steps = math.ceil(1.3 * T / at.h)
      local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
      local anchor = scene:particle { position = { 0, 0, 0 }, mass = 1 }
      local phi = math.rad(angle)
      local p = scene:particle { position = { math.sin(phi), 0, -math.cos(phi) }, mass = 1 }
      scene:pin { anchor }
      scene:force("gravity", { g = { 0, 0, -1 } })
      scene:constraint("bars", { edges = { { anchor, p } } })
      -- a quarter and five quarters of a period after its release it passes the lowest point, falling in x
      local falls = validation.crossings(-1)
      validation.each(scene, at.h, steps, function(s, t)
        falls(t, s:position(p)[1], s:velocity(p)[1])
        return #falls.times == 2
      end)
      got[k] = falls.times[2] - falls.times[1]
    end
    return got
  end,
}
