-- A tank empties through a slot beside its wall, whose lip is round, so that no eddies take anything: the speed of the jet
-- below it, where it has fallen to z from the level H.
local tank = require("_tank")
local validation = require("validation")

local g, floor, slot, lip, top, step = 9.81, 0.8, 0.125, 0.1, 1.2, 0.002 -- m/s^2, m: the tank's floor, its slot, the water; s
local T = 0.6 -- s

return validation.problem {
  title = "Torricelli's law",
  quantities = { { name = "speed of the jet, by sqrt(2 g (H - z))", reference = 1,
    source = "Torricelli 1644, Bernoulli 1738; the level sinks by (slot/width)^2 of that, which adds 0.8 %" } },
  space = { 24, 32, 48 },
  noise = 0.02,
  tolerance = 0.03,
  why = "the level sinks while water flows, and what the start has left of the unsteady flow is 1 to 2 % at 0.6 s",
  quick = { space = { 16, 20, 24 }, tolerance = 0.08 },
  solve = function(at)
    local scene, count, masses = tank.scene { n = at.n, h = step, top = top, room = top + 0.2, g = g, duration = T,
      inside = function(_, _, z) return z > floor end,
      before = function(s)
        s:corrector("obstacle", { shape = "sphere", size = { 2 * lip, 2 * lip, 2 * lip }, position = { slot + lip, 0, floor - lip } })
        s:corrector("obstacle", { shape = "box", size = { 2, 1, lip }, position = { slot + 1, 0, floor - 1.5 * lip } })
        s:corrector("obstacle", { shape = "box", size = { 2, 1, 2 * lip }, position = { slot + lip + 1, 0, floor - lip } })
      end }
    local state = scene:run { to = T }:state()
    local above, sum, n = 0, 0, 0
    for id = 1, count do
      if state:position(id)[3] > floor then above = above + masses[id] end
    end
    local H = floor + above / (1000 / at.n)
    for id = 1, count do
      local p, v = state:position(id), state:velocity(id)
      if p[3] > 0.4 and p[3] < 0.55 and p[1] < slot then
        sum, n = sum + math.sqrt((v[1] ^ 2 + v[3] ^ 2) / (2 * g * (H - p[3]))), n + 1
      end
    end
    return sum / n
  end,
}
