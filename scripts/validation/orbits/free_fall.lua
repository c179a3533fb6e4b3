-- Two bodies of masses 1 and 3 fall towards each other from rest; the time until half of the distance is gone, and until
-- nine tenths are.
local validation = require("validation")

local parts = { 0.5, 0.1 }

local function time(x) -- sqrt(r^3/(2 G M)) (acos sqrt x + sqrt(x (1 - x))), r = 1, G M = 4
  return math.sqrt(1 / 8) * (math.acos(math.sqrt(x)) + math.sqrt(x * (1 - x)))
end

local quantities = {}
for i, x in ipairs(parts) do
  quantities[i] = { name = ("time to %g of the distance"):format(x), unit = "s", reference = time(x),
    source = "closed form, the radial orbit of Kepler" }
end

return validation.problem {
  title = "Two bodies fall together",
  quantities = quantities,
  time = { 1 / 400, 1 / 800, 1 / 1600 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "order 2, 1e-5 at the finest step; at a tenth of the distance all is 30 times faster than at the start",
  forces = { nbody = { "G" } },
  quick = { time = { 1 / 200, 1 / 400, 1 / 800 }, tolerance = 1e-4 },
  solve = function(at)
    local h, steps = at.h, math.ceil(0.6 / at.h)
    local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "leapfrog" }
    scene:particle { position = { 0, 0, 0 }, mass = 1 }
    scene:particle { position = { 1, 0, 0 }, mass = 3 }
    scene:force("nbody", { G = 1 })
    local watch = { validation.crossings(-1), validation.crossings(-1) }
    validation.each(scene, h, steps, function(s, t)
      local d, v = s:position(2)[1] - s:position(1)[1], s:velocity(2)[1] - s:velocity(1)[1]
      for i, x in ipairs(parts) do watch[i](t, d - x, v) end
      return #watch[2].times == 1
    end)
    return { watch[1].times[1], watch[2].times[1] }
  end,
}
