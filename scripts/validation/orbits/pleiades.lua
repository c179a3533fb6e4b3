-- Seven bodies of masses 1 to 7 in a plane, with close encounters; their places at t = 3.
local validation = require("validation")

local x, y = { 3, 3, -1, -3, 2, -2, 2 }, { 3, -3, 2, 0, 0, -4, 4 }
local vx, vy = { 0, 0, 0, 0, 0, 1.75, -1.5 }, { 0, 0, 0, -1.25, 1, 0, 0 }
local x_end = { 0.37061391439705129, 3.2372840920572331, -3.2225590324183233, 0.65970914557753084, 0.34255817071565798,
  1.5621721014006310, -0.70030929222124954 }
local y_end = { -3.9434375855173921, -3.2713809739725499, 5.2250818434565442, -2.5906124349774695, 1.1982136933922746,
  -0.24296823449358234, 1.0914492404289797 }

local quantities = {}
for i = 1, 7 do
  local source = "Hairer, Norsett and Wanner I, II.10; test set of Bari (plei), recomputed with 113 bits"
  quantities[2 * i - 1] = { name = ("x%d at t = 3 s"):format(i), unit = "m", reference = x_end[i], scale = 1, source = source }
  quantities[2 * i] = { name = ("y%d at t = 3 s"):format(i), unit = "m", reference = y_end[i], scale = 1, source = source }
end

return validation.problem {
  title = "Pleiades: seven bodies",
  quantities = quantities,
  together = true,
  time = { 1 / 10000, 1 / 20000, 1 / 40000 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "order 2; extrapolation leaves a hundredth of the finest step's 1e-4",
  forces = { nbody = { "G" } },
  quick = { time = { 1 / 5000, 1 / 10000, 1 / 20000 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = 3, fps = 10, dt = at.h, integrator = "leapfrog" }
    for i = 1, 7 do
      scene:particle { position = { x[i], y[i], 0 }, velocity = { vx[i], vy[i], 0 }, mass = i }
    end
    scene:force("nbody", { G = 1 })
    local s, found = scene:run():state(), {}
    for i = 1, 7 do
      local p = s:position(i)
      found[2 * i - 1], found[2 * i] = p[1], p[2]
    end
    return found
  end,
}
