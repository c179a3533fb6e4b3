-- A dam breaks, and its water runs to and fro for 10 s: what it has gained or lost of its volume, and how much is in walls.
local tank = require("_tank")
local validation = require("validation")

local a, g, step = 0.25, 9.81, 0.004 -- m, m/s^2, s

return validation.problem {
  title = "Ten seconds after a dam broke",
  quantities = {
    { name = "volume gained", reference = 0, scale = 1, source = "conservation of volume" },
    { name = "particles in walls", reference = 0, scale = 1, source = "walls", tolerance = 0,
      why = "a particle is in a wall or not" },
  },
  space = { 32, 40, 48 },
  noise = 0.005,
  tolerance = 0.005,
  why = "the aim is 0.5 %; the figure trembles by 0.2 % with the places of particles",
  quick = { space = { 28, 30, 32 }, tolerance = 0.02 },
  solve = function(at)
    local T = at.quick and 0.4 or 10
    local scene = tank.scene { n = at.n, h = step, top = 2 * a, room = 3 * a, g = g, duration = T,
      inside = function(x) return x < a end }
    for _, plugin in ipairs(scene:run { to = T }:summary().plugins) do
      if plugin.name == "liquid" then return { plugin.figures.volume_drift, plugin.figures.in_walls } end
    end
  end,
}
