-- chocolate.lua: warm chocolate is poured over a ball of ice cream, runs down and sets there: what touches the ball gives it
-- its heat, and the colder chocolate gets the more viscous it is, until it stands. So that this takes seconds, heat goes two
-- hundred times as fast. With `cold` above 307 K nothing sets, and most of it runs off.
local filling, heat = require("filling"), require("heat")
local cell = param("cell", 0.005, "of the grid, m", { min = 0.002, max = 0.01 })
local warm = param("warm", 318, "of the chocolate, K", { min = 308, max = 340 })
local cold = param("cold", 258, "of the ball, K", { min = 200, max = 340 })
local duration = param("duration", 0.6, "s", { min = 0 })
local half, top, radius, middle = 0.06, 0.16, 0.03, 0.03 -- m: of the plate's side; of the box; of the ball, and its height
local density = 1250

local scene = hooke.scene { duration = duration, fps = 30, integrator = "symplectic_euler" }
scene:channel("enthalpy", { initial = heat.enthalpy("chocolate", warm) })
scene:channel("given", { initial = 0 })
local chocolate = filling.box { low = { -0.02, -0.02, 0.075 }, high = { 0.02, 0.02, 0.155 }, cell = cell, density = density,
  inside = function(x, y) return x * x + y * y < 0.014 ^ 2 end }
local ids = scene:particles { positions = chocolate.positions, mass = chocolate.mass, group = "chocolate" }:ids()
local ball = { shape = "sphere", size = { 2 * radius, 2 * radius, 2 * radius }, position = { 0, 0, middle } }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("heating", { shape = ball.shape, size = ball.size, position = ball.position, reach = cell / 2, area = cell * cell / 4,
  convection = 2e5, surroundings = cold, material = "chocolate", channel = "enthalpy", account = "given", label = "cold" })
scene:force("grid_conduction", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = density,
  material = "chocolate", conductivity = 44, conductivity_liquid = 52, channel = "enthalpy", account = "given" })
scene:force("melt", { channel = "enthalpy", material = "chocolate", viscosity = 1.5, solid = 1e6 })
scene:corrector("obstacle", { shape = ball.shape, size = ball.size, position = ball.position, restitution = 0, label = "ball" })
scene:corrector("liquid", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = density,
  viscosity_of = "melt" })

scene:measure("coat", function(s) -- part of the chocolate that is on the ball, above its middle
  local count = 0
  for _, id in ipairs(ids) do
    local p = s:position(id)
    local away = math.sqrt(p[1] ^ 2 + p[2] ^ 2 + (p[3] - middle) ^ 2)
    if p[3] > middle and away < radius + 2 * cell then count = count + 1 / #ids end
  end
  return count
end)
scene:measure("set", function(s) -- part of it that is solid
  local sum = 0
  for _, id in ipairs(ids) do sum = sum + (1 - s:field("molten", id)) / #ids end
  return sum
end)
heat.measure_balance(scene, ids)
scene:output("frames", { surface = 0.3 * cell, plain = { 0.2, 0.09, 0.04 }, color = "none", ground_height = 0, fov = 20,
  keyframes = { 0, 0.12, -0.42, 0.2, 0, 0, 0.07, 0.25, 0.09, -0.315, 0.15, 0, 0, 0.032 } })
return scene
