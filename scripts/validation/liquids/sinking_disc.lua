-- A disc sinks between two walls of a viscous liquid: its speed where its weight and its drag are in balance.
local tank = require("_tank")
local validation = require("validation")

local g, mu, R, density = 9.81, 800, 0.125, 3000 -- m/s^2, Pa s, m, kg/m^3
local places = 3 -- of the disc in its cell, by which its speed differs: they are averaged
local k = 2 * R -- of the walls' distance, 1 m
local drag = 4 * math.pi * mu / (math.log(1 / k) - 0.9157 + 1.7244 * k ^ 2 - 1.7302 * k ^ 4 + 2.4056 * k ^ 6 - 4.5913 * k ^ 8)

return validation.problem {
  title = "A disc that sinks between walls",
  quantities = { { name = "speed", unit = "m/s", reference = math.pi * R * R * (density - 1000) * g / drag,
    source = "Faxen 1946, drag of a cylinder in the middle between two walls, slow flow, to the order (d/W)^8" } },
  space = { 16, 24, 32 },
  time = { 0.0025, 0.00125, 0.000625 },
  noise = 0.02,
  tolerance = 0.05,
  why = "walls that cover parts of cells and the splitting of viscosity from pressure leave 11 to 24 % in the levels, which the limit is "
    .. "without; the Reynolds number is 0.017",
  quick = { space = { 8, 10, 12 }, time = { 0.01, 0.005, 0.0025 }, tolerance = 0.4 },
  solve = function(at)
    local function speed(start) -- m/s, of a disc that begins at the height start, m
      local disc
      local scene = tank.scene { n = at.n, h = at.h, top = 1.5, room = 1.5, g = g, duration = 0.4, with = { viscosity = mu },
        inside = function(x, _, z) return (x - 0.5) ^ 2 + (z - start) ^ 2 > R * R end,
        before = function(s)
          disc = s:rigid { shape = "cylinder", radius = R, length = 1 / at.n, density = density, position = { 0.5, 0, start },
            orientation = { math.pi / 2, 0, 0 } }
        end }
      local function height(t) return disc:position(scene:run { to = t }:state())[3] end
      local early = height(0.2)
      return (early - height(0.4)) / 0.2
    end
    local sum = 0
    local count = at.quick and 1 or places
    for place = 0, count - 1 do sum = sum + speed(0.8 + (place + 0.5) / (count * at.n)) / count end
    return sum
  end,
}
