-- Three equal masses chase each other along a figure of eight; the period, from the passages of the one that starts in
-- the middle.
local validation = require("validation")

local function flight(h, steps, watch)
  local scene = hooke.scene { duration = steps * h, fps = 1 / h, dt = h, integrator = "leapfrog" }
  local v = { -0.93240737, -0.86473146 }
  scene:particle { position = { 0.97000436, -0.24308753, 0 }, velocity = { -v[1] / 2, -v[2] / 2, 0 }, mass = 1 }
  scene:particle { position = { -0.97000436, 0.24308753, 0 }, velocity = { -v[1] / 2, -v[2] / 2, 0 }, mass = 1 }
  scene:particle { position = { 0, 0, 0 }, velocity = { v[1], v[2], 0 }, mass = 1 }
  scene:force("nbody", { G = 1 })
  validation.each(scene, h, steps, function(s, t) return watch(t, s:position(3)[1], s:velocity(3)[1]) == 1 end)
end

return validation.problem {
  title = "Three bodies on a figure of eight",
  quantities = {
    { name = "period", unit = "s", reference = 6.32591398,
      source = "Chenciner and Montgomery, Annals of Mathematics 152 (2000); start and period by Simo, 9 digits" },
  },
  time = { 1 / 200, 1 / 400, 1 / 800 },
  order = { time = 2 },
  tolerance = 1e-8,
  why = "the published start and period have 8 and 9 digits",
  forces = { nbody = { "G" } },
  quick = { time = { 1 / 50, 1 / 100, 1 / 200 }, tolerance = 1e-5 },
  solve = function(at)
    local steps, falls = math.ceil(6.5 / at.h), validation.crossings(-1)
    flight(at.h, steps, falls)
    return falls.times[1]
  end,
}
