-- wax_figure.lua: a lamp shines on the head of a figure of wax: it melts, runs down the cold body and freezes on it. The
-- wax is a liquid that is so viscous when it is solid that it stands. Colours are the enthalpy: solid below 0, molten above
-- 200 kJ/kg.
local filling, heat = require("filling"), require("heat")
local cell = param("cell", 0.012, "of the grid, m", { min = 0.0015, max = 0.02 })
local power = param("power", 4000, "of the lamp, W", { min = 0 })
local duration = param("duration", 4, "s", { min = 0 })
local density, half, top = 780, 0.06, 0.14 -- kg/m^3; m, of the plate's side; of the box

local function head(x, y, z) return x * x + y * y + (z - 0.09) ^ 2 < 0.026 ^ 2 end
local function body(x, y, z) return z < 0.075 and math.sqrt(x * x + y * y) < 0.036 - 0.25 * z end

local scene = hooke.scene { duration = duration, fps = 30, integrator = "symplectic_euler" }
local wax = filling.box { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = density,
  inside = function(x, y, z) return head(x, y, z) or body(x, y, z) end }
scene:channel("enthalpy", { initial = heat.enthalpy("wax", 315) })
local ids = scene:particles { positions = wax.positions, mass = wax.mass, group = "wax" }:ids()
local lit = {}
for k, id in ipairs(ids) do
  local p = wax.positions[k]
  if head(p[1], p[2], p[3]) then lit[#lit + 1] = id end
end
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("heating", { particles = lit, power = function(t) return t < 3 and power / #lit or 0 end, material = "wax",
  channel = "enthalpy" })
scene:force("grid_conduction", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = density,
  material = "wax", channel = "enthalpy" })
scene:force("melt", { channel = "enthalpy", material = "wax", viscosity = 0.05, solid = 1e6 })
scene:corrector("liquid", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = density,
  viscosity_of = "melt" })

scene:measure("height", function(s) -- of the highest particle
  local z = 0
  for _, id in ipairs(ids) do z = math.max(z, s:position(id)[3]) end
  return z
end, { unit = "m" })
scene:measure("molten", function(s) -- part of the wax
  local sum = 0
  for _, id in ipairs(ids) do sum = sum + s:field("molten", id) / #ids end
  return sum
end)
scene:output("frames", { color = "enthalpy", range = { -8000, 300e3 }, unit = "J/kg", map = "inferno", radius = 0.35 * cell,
  from = { 0.12, -0.38, 0.17 }, look_at = { 0, 0, 0.05 }, ground_height = 0, fov = 20 })
return scene
