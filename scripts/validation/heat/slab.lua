-- A slab of the temperature 1 whose one side is at 0 and whose other is closed, and a ball whose surface is: the
-- temperatures at the closed side and in the middle.
local bar, validation = require("_bar"), require("validation")

local T = 0.2 -- s; the conductivity, the capacity, the density and the size are 1

local function slab()
  local sum = 0
  for n = 0, 40 do
    local q = (n + 0.5) * math.pi
    sum = sum + 2 / q * (n % 2 == 0 and 1 or -1) * math.exp(-q * q * T)
  end
  return sum
end

local function ball() -- in the middle
  local sum = 0
  for n = 1, 40 do sum = sum - 2 * (n % 2 == 0 and 1 or -1) * math.exp(-(n * math.pi) ^ 2 * T) end
  return sum
end

local function cylinder() -- on its axis
  local numerics, sum = require("numerics"), 0
  for n = 1, 20 do
    local z = numerics.bessel_zero(0, n)
    sum = sum + 2 / (z * numerics.bessel_j(1, z)) * math.exp(-z * z * T)
  end
  return sum
end

local function middle(n, section)
  local scene, ids = bar.scene { n = n, duration = T, section = section, held = { n },
    law = { capacity = 1, conductivity = 1 }, enthalpy = function(k) return k == n and 0 or 1 end }
  return scene:run():state():channel("enthalpy", ids[0])
end

return validation.problem {
  title = "Cooling of a slab, a cylinder and a ball",
  quantities = {
    { name = "slab, at the closed side", reference = slab, source = "Carslaw and Jaeger 1959, 3.4, equation 8" },
    { name = "cylinder, on its axis", reference = cylinder, source = "Carslaw and Jaeger 1959, 7.6, equation 8",
      order = { space = 2, within = 0.5 } }, -- the first particle, on the axis, has h^2 log h beside h^2
    { name = "ball, in the middle", reference = ball, source = "Carslaw and Jaeger 1959, 9.3, equation 5" },
  },
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 1e-4,
  why = "order 2, 1e-3 with 64 cells",
  forces = { conduction = { "edges", "section", "held", "channel", "account", "capacity", "conductivity" } },
  quick = { space = { 8, 16, 32 }, tolerance = 2e-3 },
  solve = function(at)
    return { middle(at.n), middle(at.n, function(r) return 2 * math.pi * r end),
      middle(at.n, function(r) return 4 * math.pi * r * r end) }
  end,
}
