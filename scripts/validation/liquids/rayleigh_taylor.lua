-- A liquid that hangs from its box: gravity pulls it away from the wall, and a small wave of its surface grows as
-- cosh(s t), as sqrt(g k tanh(k d)) says. What is measured is the motion of the wave, which grows as sinh(s t). Particles are on
-- a lattice: what chance makes uneven within some cells would grow much faster.
local numerics = require("numerics")
local tank = require("_tank")
local validation = require("validation")

local g, k, d, a, step = 9.81, 2 * math.pi, 0.5, 0.004, 0.004
local early, late = 0.08, 0.28 -- s: the wave is then 4.8 and 18 mm high, k times which is at most 0.11

local function motion(state, masses)
  local sum = 0
  for id, mass in ipairs(masses) do
    sum = sum + mass * math.sin(k * state:position(id)[1]) * state:velocity(id)[1]
  end
  return sum
end

return validation.problem {
  title = "Growth of a hanging liquid's waves",
  quantities = { { name = "rate", unit = "1/s", reference = math.sqrt(g * k * (1 - 2 / (math.exp(2 * k * d) + 1))),
    source = "Taylor 1950 and Lamb 1932, section 228, with -g: sqrt(g k tanh(k d))" } },
  space = { 16, 24, 32 },
  noise = 0.02,
  tolerance = 0.03,
  why = "steps of 0.004 s are 3 % of 1/s, to the first order, and the wave's height changes the rate by (k a)^2",
  quick = { space = { 12, 14, 16 }, tolerance = 0.06 },
  solve = function(at)
    local scene, _, masses = tank.scene { n = at.n, h = step, top = d + 0.1, room = d + 0.25, g = -g, duration = late, scatter = 0,
      level = function(x) return d + a * math.cos(k * x) end }
    local first = motion(scene:run { to = early }:state(), masses)
    local ratio = motion(scene:run { to = late }:state(), masses) / first
    return numerics.root(function(s) return (math.exp(s * late) - math.exp(-s * late))
      / (math.exp(s * early) - math.exp(-s * early)) - ratio end, 1, 30)
  end,
}
