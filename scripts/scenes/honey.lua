-- honey.lua: a thread of honey falls onto a plate, where it folds and sinks into a heap that spreads slowly. It is as
-- viscous as cold honey (100 Pa s), sticks to the plate, and its surface is seen.
local filling = require("filling")
local cell = param("cell", 0.004, "of the grid, m", { min = 1e-3, max = 0.01 })
local viscosity = param("viscosity", 100, "Pa s", { min = 0 })
local radius, low, high, density = 0.012, 0.01, 0.17, 1400 -- m: of the thread, its ends above the plate; kg/m^3
local half, top = 0.06, 0.18                              -- m, of the plate's side; of the box

local function inside(x, y, z) -- a thread that is not quite straight
  local bend = 0.003 * (z - low) / (high - low)
  return (x - bend * math.cos(60 * z)) ^ 2 + (y - bend * math.sin(60 * z)) ^ 2 < radius ^ 2
end

local scene = hooke.scene { duration = 1, fps = 30, integrator = "symplectic_euler" }
local honey = filling.box { low = { -2 * radius, -2 * radius, low }, high = { 2 * radius, 2 * radius, high }, cell = cell,
  density = density, inside = inside }
scene:particles { positions = honey.positions, mass = honey.mass, group = "honey" }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:corrector("liquid", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = density,
  viscosity = viscosity })

scene:measure("height", function(s) -- of the centre of mass
  local z = 0
  for id = 1, s.n do z = z + s:position(id)[3] / s.n end
  return z
end, { unit = "m" })
scene:measure("width", function(s) -- of the foot: twice the mean distance from the axis of what is on the plate
  local sum, count = 0, 0
  for id = 1, s.n do
    local p = s:position(id)
    if p[3] < 2 * cell then sum, count = sum + math.sqrt(p[1] * p[1] + p[2] * p[2]), count + 1 end
  end
  return count > 0 and 2 * sum / count or 0
end, { unit = "m" })
scene:output("frames", { surface = 0.3 * cell, surface_look = "water", surface_absorption = { 8, 45, 220 }, surface_index = 1.49,
  color = "none", from = { 0.1, -0.4, 0.2 }, look_at = { 0, 0, 0.075 }, ground_height = 0, fov = 22 })
return scene
