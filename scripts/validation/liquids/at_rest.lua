-- A full box after 1,000 steps, in each of which gravity gives 0.05 m/s: the pressure is hydrostatic, and nothing moves.
local tank = require("_tank")
local validation = require("validation")

local step = 0.005

return validation.problem {
  title = "A column of water at rest",
  quantities = { { name = "speed after 1,000 steps", unit = "m/s", reference = 0, scale = 1,
    source = "hydrostatics" } },
  space = { 4, 6, 8 },
  noise = 1e-10,
  tolerance = 1e-10,
  why = "the pressure is solved to 1e-11 of what gravity gives in a step, and the places of particles are evened",
  quick = { space = { 3, 4, 5 }, tolerance = 1e-4 },
  solve = function(at)
    local steps = at.quick and 100 or 1000
    local scene, count = tank.scene { n = at.n, h = step, top = 1, g = 9.81, duration = steps * step, with = { tolerance = 1e-11 } }
    local state, fastest = scene:run():state(), 0
    for id = 1, count do
      for _, v in ipairs(state:velocity(id)) do fastest = math.max(fastest, math.abs(v)) end
    end
    return fastest
  end,
}
