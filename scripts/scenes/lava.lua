-- lava.lua: lava runs down steps and freezes there: its skin gives heat to the air and its inside to the skin, and the colder
-- it gets the more viscous it is, until it stands. So that this takes seconds, heat goes four hundred times as fast.
local filling, heat = require("filling"), require("heat")
local cell = param("cell", 0.04, "of the grid, m", { min = 0.01, max = 0.05 })
local convection = param("convection", 9000, "to the air, W/(m^2 K)", { min = 0 })
local duration = param("duration", 3, "s", { min = 0 })
local high, depth, rise, run = { 1.2, 0.3, 0.6 }, 0.3, 0.1, 0.3 -- m: the box; the steps
local density = 2700

local scene = hooke.scene { duration = duration, fps = 30, integrator = "symplectic_euler" }
scene:channel("enthalpy", { initial = heat.enthalpy("basalt", 1475) })
scene:channel("given", { initial = 0 })
local lava = filling.box { low = { 0, 0, 3 * rise }, high = { run, depth, 0.55 }, cell = cell, density = density }
local ids = scene:particles { positions = lava.positions, mass = lava.mass, group = "lava" }:ids()
local skin = {}
for k, p in ipairs(lava.positions) do
  local inside = math.min(run - p[1], p[2], depth - p[2], 0.55 - p[3])
  if inside < 0.04 then skin[#skin + 1] = ids[k] end
end
for k = 1, 3 do
  scene:corrector("obstacle", { shape = "box", size = { k * run, depth + 0.2, rise }, restitution = 0,
    position = { k * run / 2, depth / 2, (3.5 - k) * rise }, label = "step " .. k })
end
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("heating", { particles = skin, area = cell * cell / 8, convection = convection, surroundings = 300,
  material = "basalt", channel = "enthalpy", account = "given" })
scene:force("melt", { channel = "enthalpy", material = "basalt", viscosity = 30, solid = 1e7 })
scene:force("grid_conduction", { low = { 0, 0, 0 }, high = high, cell = cell, density = density, material = "basalt",
  conductivity = 600, conductivity_liquid = 400, channel = "enthalpy", account = "given" })
scene:corrector("liquid", { low = { 0, 0, 0 }, high = high, cell = cell, density = density, viscosity_of = "melt" })

scene:measure("front", function(s) -- of the farthest
  local x = 0
  for id = 1, s.n do x = math.max(x, s:position(id)[1]) end
  return x
end, { unit = "m" })
scene:measure("molten", function(s) -- part of the lava
  local sum = 0
  for id = 1, s.n do sum = sum + s:field("molten", id) / s.n end
  return sum
end)
scene:output("frames", { color = "enthalpy", range = { 0, 640e3 }, unit = "J/kg", map = "inferno", radius = 0.35 * cell,
  from = { 2.2, -1.9, 1.3 }, look_at = { 0.55, 0.15, 0.2 }, ground_height = 0, fov = 26 })
return scene
