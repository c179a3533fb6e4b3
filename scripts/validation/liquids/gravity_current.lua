-- A viscous heap in the middle of a floor that holds it spreads to both sides, far longer than high: its length grows as
-- t^(1/5). Its mean distance from the middle is compared, to the fifth power and between two times, which leaves out when
-- it began. The box is higher than the heap: under a top that holds it back the first layer would hang.
local numerics = require("numerics")
local tank = require("_tank")
local validation = require("validation")

local g, nu, side, room = 9.81, 0.1, 0.25, 0.375 -- m/s^2, m^2/s, m, m
local early, late = 2, 3.2 -- s: it is then 0.35 to 0.4 m long to either side
local q = side * side / 2 -- m^2, to one side
local function shape(y) return (1 - y * y) ^ (1 / 3) end
local mean = numerics.integrate(function(y) return y * shape(y) end, 0, 1) / numerics.integrate(shape, 0, 1)

local function distance(state, masses)
  local sum, all = 0, 0
  for id, mass in ipairs(masses) do sum, all = sum + mass * math.abs(state:position(id)[1] - 0.5), all + mass end
  return sum / all
end

return validation.problem {
  title = "A viscous current over a floor",
  quantities = { { name = "d(x^5)/dt, by (g q^3/3 nu)", reference = (1.41124477 * mean) ^ 5,
    source = "Huppert 1982, Journal of Fluid Mechanics 121, 43, eq. 2.13: x = 1.411 (g q^3/3 nu)^(1/5) t^(1/5)" } },
  space = { 24, 32, 48 },
  time = { 0.01, 0.005, 0.0025 },
  noise = 0.05,
  tolerance = 0.12,
  why = "of the fifth power, 2 % of the length: the heap is 2 to 4 cells high and not yet far longer than that",
  quick = { space = { 20, 24, 28 }, time = { 0.02, 0.01, 0.005 }, tolerance = 0.3 },
  solve = function(at)
    local scene, _, masses = tank.scene { n = at.n, h = at.h, top = side, room = room, g = g, duration = late,
      inside = function(x) return math.abs(x - 0.5) < side / 2 end, with = { viscosity = 1000 * nu } }
    local first = distance(scene:run { to = early }:state(), masses)
    local last = distance(scene:run { to = late }:state(), masses)
    return (last ^ 5 - first ^ 5) / (late - early) / (g * q ^ 3 / (3 * nu))
  end,
}
