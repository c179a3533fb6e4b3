-- A disc sinks between two walls of a viscous liquid: its speed where its weight and its drag are in balance.
local tank = require("_tank")
local validation = require("validation")

local g, mu, R, density, step = 9.81, 800, 0.125, 3000, 0.00125 -- m/s^2, Pa s, m, kg/m^3, s
local k = 2 * R -- of the walls' distance, 1 m
local drag = 4 * math.pi * mu / (math.log(1 / k) - 0.9157 + 1.7244 * k ^ 2 - 1.7302 * k ^ 4 + 2.4056 * k ^ 6 - 4.5913 * k ^ 8)

return validation.problem {
  title = "A disc that sinks between walls",
  quantities = { { name = "speed", unit = "m/s", reference = math.pi * R * R * (density - 1000) * g / drag,
    source = "Faxen 1946, drag of a cylinder in the middle between two walls, slow flow, to the order (d/W)^8" } },
  space = { 16, 24, 32 },
  noise = 0.02,
  tolerance = 0.05,
  why = "of what the levels tend to: they are 24 to 11 % too fast (8 % with 48 cells), with order 1, as walls that cover parts of cells "
    .. "and the splitting from pressure have; the Reynolds number is 0.017",
  quick = { space = { 12, 14, 16 }, tolerance = 0.4 },
  solve = function(at)
    local disc
    local start = 0.8
    local scene = tank.scene { n = at.n, h = step, top = 1.5, room = 1.5, g = g, duration = 0.4, with = { viscosity = mu },
      inside = function(x, _, z) return (x - 0.5) ^ 2 + (z - start) ^ 2 > R * R end,
      before = function(s)
        disc = s:rigid { shape = "cylinder", radius = R, length = 1 / at.n, density = density, position = { 0.5, 0, start },
          orientation = { math.pi / 2, 0, 0 } }
      end }
    local function height(t) return disc:position(scene:run { to = t }:state())[3] end
    local early = height(0.2)
    return (early - height(0.4)) / 0.2
  end,
}
