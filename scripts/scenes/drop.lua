-- drop.lua: a drop falls into a pool that is shallower than it is wide, and throws up a crown; the tension of the surface rounds
-- its edge.
local filling = require("filling")
local cell = param("cell", 0.0005, "of the grid, m", { min = 1e-4, max = 2e-3 })
local radius = param("radius", 0.0025, "of the drop, m", { min = 1e-3, max = 0.01 })
local speed = param("speed", 3, "of the drop, m/s", { min = 0, max = 10 })
local tension = param("tension", 0.072, "of the surface, N/m", { min = 0 })
local half, top, level = 0.0105, 0.014, 0.003 -- m: of the pool, half its side; of the box; of the water

local scene = hooke.scene { duration = 0.007, fps = 500, integrator = "symplectic_euler" }
local z = level + 1.5 * radius
local water = filling.box { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = 1000,
  inside = function(x, y, h) return h < level or x * x + y * y + (h - z) ^ 2 < radius ^ 2 end }
local velocities = {}
for k, p in ipairs(water.positions) do velocities[k] = { 0, 0, p[3] < level and 0 or -speed } end
scene:particles { positions = water.positions, velocities = velocities, mass = water.mass, group = "water" }
scene:force("gravity", { g = { 0, 0, -9.81 } })
filling.tank(scene, { -half, -half, 0 }, { half, half, top })
scene:corrector("liquid", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = 1000,
  tension = tension })

local n = #water.positions
scene:measure("top", function(s) -- above the pool, of the highest
  local h = 0
  for id = 1, n do h = math.max(h, s:position(id)[3]) end
  return h - level
end, { unit = "m" })
scene:output("frames", { surface = 0.35 * cell, surface_cell = 0.4 * cell, surface_look = "water",
  surface_absorption = { 60, 15, 5 }, color = "none", surface_cut = true, obstacles = false,
  from = { 0.018, -0.047, 0.022 }, look_at = { 0, 0, 0.0045 }, ground_height = 0, fov = 24 })
return scene
