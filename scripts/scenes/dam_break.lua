-- dam_break.lua: a column of water, twice as high as wide, collapses and runs along the floor of a tank to its other wall
-- (Martin and Moyce 1952); depth=0.5 makes it a tank of that depth, with a pillar in the water's way.
local filling = require("filling")
local a = param("a", 0.5, "width of the column, m", { min = 0.05 })
local cell = param("cell", 0.03125, "of the grid, m", { min = 1e-3 })
local depth = param("depth", 0, "of the tank, m; 0: a plane", { min = 0 })
local transfer = param("transfer", "apic", "apic, flip or pic")

local scene = hooke.scene { duration = 3, fps = 60, integrator = "symplectic_euler" }
local water = filling.box { low = { 0, 0, 0 }, high = { a, depth, 2 * a }, cell = cell, density = 1000 }
scene:particles { positions = water.positions, mass = water.mass, group = "water" }
scene:force("gravity", { g = { 0, 0, -9.81 } })
if depth > 0 then
  scene:corrector("obstacle", { shape = "box", size = { 0.3 * a, 0.3 * depth, 4 * a }, label = "pillar",
    position = { 2.6 * a, 0.5 * depth, 1.5 * a } })
end
scene:corrector("liquid", { low = { 0, 0, 0 }, high = { 4 * a, depth, 3 * a }, cell = cell, density = 1000,
  transfer = transfer })

local n = #water.positions
-- The front, by the column's width, where half a cell's layer of water has come to (but the last particles).
scene:measure("front", function(s)
  local counts, last, full = {}, 0, depth > 0 and 8 * depth / cell or 4
  for id = 1, n do
    local k = math.floor(s:position(id)[1] / cell)
    counts[k], last = (counts[k] or 0) + 1, math.max(last, k)
  end
  for k = last, 0, -1 do
    local part = (counts[k] or 0) / full
    if part >= 0.5 then return (k + math.min(part, 1)) * cell / a end
  end
  return 0
end)
scene:measure("height", function(s) -- of the centre of mass, by that of water at rest in the whole tank
  local z = 0
  for id = 1, n do z = z + s:position(id)[3] end
  return z / n / (a / 4)
end)
if depth > 0 then
  scene:output("frames", { surface = 0.3 * cell, color = "none", plain = { 0.35, 0.6, 0.85 }, from = { 5 * a, -7 * a, 3.6 * a },
    look_at = { 2 * a, 0.5 * depth, 0.5 * a }, ground_height = 0 })
else
  scene:output("frames", { color = "speed", range = { 0, 4 }, from = { 2 * a, -6 * a, 1.2 * a }, radius = 0.3 * cell,
    look_at = { 2 * a, 0, 1.2 * a }, ground_height = 0 })
end
return scene
