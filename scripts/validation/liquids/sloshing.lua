-- A tank that is shaken from side to side, at 0.7 of its first frequency: how high the water's first mode swings. In the
-- tank's frame gravity turns to and fro, and a mode q is driven: q'' + w^2 q = F sin(W t).
local tank = require("_tank")
local validation = require("validation")

local g, k, d, pull, step = 9.81, math.pi, 0.5, 0.2, 0.005 -- m/s^2, 1/m, m, m/s^2 at most, s
local function tanh(x) return 1 - 2 / (math.exp(2 * x) + 1) end
local w = math.sqrt(g * k * tanh(k * d))
local W = 0.7 * w
local T = 2.4 -- s

-- m: of cos(k x) in the height, from rest; x is 1/2 - (4/pi^2) cos(k x) - ..., so that the pull drives the mode by -(4/pi) tanh(k d) of it.
local function height(t)
  local F = -4 * pull / math.pi * tanh(k * d) -- m/s^2
  return F / (w * w - W * W) * (math.sin(W * t) - W / w * math.sin(w * t))
end

local times = { 0.8, 1.6, 2.4 }
local quantities = {}
for i, t in ipairs(times) do
  quantities[i] = { name = ("height at %g s"):format(t), unit = "m", reference = height(t), scale = 0.02,
    source = "Faltinsen and Timokha 2009, Sloshing, section 5.3: linear modes" }
end

return validation.problem {
  title = "Water in a tank that is shaken",
  quantities = quantities,
  space = { 16, 24, 32 },
  noise = 0.04,
  tolerance = 0.06,
  why = "of 0.02 m: heights to the second order, k a^2, are 3 % of that, and steps of order 1 leave 1 %",
  quick = { space = { 12, 14, 16 }, tolerance = 0.12 },
  solve = function(at)
    local scene, _, masses = tank.scene { n = at.n, h = step, top = d, room = d + 0.2, duration = T }
    scene:force("gravity", { g = function(t) return pull * math.sin(W * t), 0, -g end })
    local function mode(state)
      local sum = 0
      for id, mass in ipairs(masses) do sum = sum + mass * math.cos(k * state:position(id)[1]) end
      return sum / (1000 / at.n / 2)
    end
    local first, list = mode(scene:run { to = 0 }:state()), {}
    for i, t in ipairs(times) do list[i] = mode(scene:run { to = t }:state()) - first end
    return list
  end,
}
