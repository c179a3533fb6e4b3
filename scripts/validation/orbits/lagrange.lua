-- Three unequal masses in the corners of an equilateral triangle keep it, turning and breathing on similar ellipses: their
-- distance after a period, and their angle after half of one. (The triangle is unstable: errors grow.)
local validation = require("validation")

local masses, e = { 1, 2, 3 }, 0.3
local total = 6
local side = 1 -- at the apocentre
local a = side / (1 + e)
local T = 2 * math.pi * math.sqrt(a ^ 3 / total)
local rate = math.sqrt(total * a * (1 - e * e)) / side ^ 2 -- L/r^2 of the relative motion, G = 1

return validation.problem {
  title = "Lagrange's triangle of three bodies",
  quantities = {
    { name = "side after half a period", unit = "m", reference = a * (1 - e), source = "Lagrange 1772: similar ellipses" },
    { name = "side after a period", unit = "m", reference = side, order = { time = 4 },
      source = "Lagrange 1772: similar ellipses; stationary there, so that the error in time counts squared" },
    { name = "angle of side 1-2 after a quarter period", unit = "rad",
      source = "Kepler's equation, solved to rounding", reference = function()
        local M = math.pi + math.pi / 2 -- from the apocentre
        local E = M
        for _ = 1, 60 do E = E - (E - e * math.sin(E) - M) / (1 - e * math.cos(E)) end
        local nu = 2 * math.atan(math.sqrt((1 + e) / (1 - e)) * math.tan(E / 2))
        return (nu - math.pi) % (2 * math.pi)
      end },
  },
  time = { T / 100, T / 200, T / 400 },
  order = { time = 2 },
  tolerance = 2e-5,
  why = "order 2, 1e-3 at the finest step, a hundredth of it extrapolated",
  forces = { nbody = { "G" } },
  quick = { time = { T / 100, T / 200, T / 400 }, tolerance = 1e-4 },
  solve = function(at)
    local corners = { { 0, 0 }, { side, 0 }, { side / 2, side * math.sqrt(3) / 2 } }
    local cx, cy = 0, 0
    for i, m in ipairs(masses) do cx, cy = cx + m * corners[i][1] / total, cy + m * corners[i][2] / total end
    local scene = hooke.scene { duration = T, fps = 4 / T, dt = at.h, integrator = "leapfrog" }
    for i, m in ipairs(masses) do
      local x, y = corners[i][1] - cx, corners[i][2] - cy
      scene:particle { position = { x, y, 0 }, velocity = { -rate * y, rate * x, 0 }, mass = m }
    end
    scene:force("nbody", { G = 1 })
    local function arm(t)
      local s = scene:run { to = t }:state()
      local p, q = s:position(1), s:position(2)
      return q[1] - p[1], q[2] - p[2]
    end
    local x, y = arm(T / 4)
    local angle = math.atan(y, x) % (2 * math.pi)
    local x2, y2 = arm(T / 2)
    local x4, y4 = arm(T)
    return { math.sqrt(x2 * x2 + y2 * y2), math.sqrt(x4 * x4 + y4 * y4), angle }
  end,
}
