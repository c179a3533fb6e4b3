-- boat.lua: a boat of cloth on ribs, half an ellipsoid with a rim, is let go over water that sways in its tank, and rides on it.
local filling = require("filling")
local cell = param("cell", 0.05, "of the grid, m", { min = 0.02, max = 0.1 })
local mass = param("mass", 8, "of the boat, kg", { min = 1, max = 20 })
local wave = param("wave", 0.04, "height of the water's wave, m", { min = 0, max = 0.1 })
local stiffness = param("stiffness", 600, "of the ribs, N/m", { min = 1 })
local high, level = { 1.6, 0.8, 0.8 }, 0.4 -- m: of the tank; of the water
local long, wide, deep, rim = 0.38, 0.2, 0.14, 0.1 -- m: half the boat's length and width, its depth, and its sides above

local scene = hooke.scene { duration = 3, fps = 30, dt = 0.002, integrator = "symplectic_euler" }
local water = filling.box { low = { 0, 0, 0 }, high = high, cell = cell, density = 1000,
  level = function(x) return level + wave * math.cos(math.pi * x / high[1]) end }
scene:particles { positions = water.positions, masses = water.masses, group = "water" }

-- Rings about the keel's middle, of which the last two are the rim's.
local around, rings = 16, 5
local vertices, faces = { { 0, 0, -deep } }, {}
for i = 1, rings do
  local part = math.min(i / (rings - 1), 1)
  local up = i == rings and rim or -deep * math.sqrt(1 - part ^ 2)
  for k = 1, around do
    local angle = 2 * math.pi * k / around
    vertices[#vertices + 1] = { long * part * math.cos(angle), wide * part * math.sin(angle), up }
  end
end
for k = 1, around do
  local next = k % around + 1
  faces[#faces + 1] = { 1, 1 + k, 1 + next }
  for i = 0, rings - 2 do
    local a, b = 1 + i * around + k, 1 + i * around + next
    faces[#faces + 1], faces[#faces + 2] = { a, a + around, b }, { b, a + around, b + around }
  end
end
local boat = scene:mesh { vertices = vertices, faces = faces, origin = { 0.5, 0.4, level + wave + deep }, mass = mass,
  group = "boat" }
local ids, ribs = boat:ids(), {}
for a = 1, #ids do
  for b = a + 1, #ids do ribs[#ribs + 1] = { ids[a], ids[b] } end
end
scene:force("springs", { edges = ribs, k = stiffness, damping = 0.2 })
scene:force("gravity", { g = { 0, 0, -9.81 } })
filling.tank(scene, { 0, 0, 0 }, high)
scene:corrector("liquid", { low = { 0, 0, 0 }, high = high, cell = cell, density = 1000 })

scene:measure("keel", function(s) return s:position(ids[1])[3] end, { unit = "m" }) -- its height
scene:measure("shipped", function(s) -- of the water that is in the boat, above its keel's middle part
  local keel, count = s:position(ids[1]), 0
  for id = 1, #water.positions do
    local p = s:position(id)
    if math.abs(p[1] - keel[1]) < long / 3 and math.abs(p[2] - keel[2]) < wide / 3 and p[3] > keel[3] + deep / 3 then
      count = count + water.masses[id]
    end
  end
  return count
end, { unit = "kg" })
scene:output("frames", { surface = 0.4 * cell, surface_of = "water", surface_look = "water", surface_absorption = { 4, 1.2, 0.5 },
  plain = { 0.8, 0.3, 0.2 }, color = "none", springs = "off", surface_cut = true, obstacles = false,
  from = { 2.5, -1.9, 1.7 }, look_at = { 0.78, 0.4, 0.25 }, ground_height = 0 })
return scene
