-- sand_castle.lua: a wave runs up to a sand castle and takes it. Damp sand holds as a solid does and sand that is full of
-- water flows, so it melts, with its content of water in the place of an enthalpy (Carlson, Mucha, Van Horn, Turk 2002):
-- below 0 it stands, above 1 it flows, and water goes from where there is much to where there is little. What the water
-- loses the sand gets. Sand is as heavy as water here. Without a wave (wave=0.02) it stands.
local filling = require("filling")
local cell = param("cell", 0.02, "of the grid, m", { min = 0.008, max = 0.04 })
local wave = param("wave", 0.2, "height of the water behind the gate, m", { min = 0.02, max = 0.28 })
local soaks = param("soaks", 1e-3, "diffusivity of the water in the sand, m^2/s", { min = 0 })
local duration = param("duration", 1.2, "s", { min = 0 })
local low, high, gate = { 0, 0, 0 }, { 0.96, 0.32, 0.32 }, 0.24 -- m: the tank; the gate's place
local density, at, reach = 1000, { 0.64, 0.16 }, 0.1            -- kg/m^3; m: the castle's middle, half its side

-- A wall with battlements, four round towers with cones, and a keep.
local function castle(x, y, z)
  local a, b = math.abs(x - at[1]), math.abs(y - at[2])
  local out = math.sqrt((a - 0.8 * reach) ^ 2 + (b - 0.8 * reach) ^ 2)
  if out < 0.04 and z < 0.1 or out < 0.045 - 0.9 * (z - 0.1) and z >= 0.1 then return true end
  if math.max(a, b) < 0.045 then return z < 0.13 end
  return math.max(a, b) < reach and (math.max(a, b) > reach - 0.045 and z < 0.06 or z < 0.03)
end

local scene = hooke.scene { duration = duration, fps = 30, integrator = "symplectic_euler" }
scene:channel("water", { initial = 2 })
scene:channel("tint", { initial = { 0.85, 0.7, 0.45 } }) -- of the sand
scene:channel("seen", { initial = 0 }) -- as particles: the sea is a surface
local sea = filling.box { low = low, high = { gate, high[2], wave }, cell = cell, density = density }
local sand = filling.box { low = { at[1] - 0.14, at[2] - 0.14, 0 }, high = { at[1] + 0.14, at[2] + 0.14, 0.16 }, cell = cell,
  density = density, inside = castle }
local ids = scene:particles { positions = sea.positions, mass = sea.mass, group = "sea" }:ids()
local grains = {}
for k, p in ipairs(sand.positions) do
  grains[k] = scene:particle { position = p, mass = sand.mass, group = "sand", water = -0.3, seen = 1 }
  ids[#ids + 1] = grains[k]
end
local law = { solidus = 300, liquidus = 301, latent = 1, capacity = 1 } -- by which 1 K stands for a content of 1
local function with(more)
  for name, value in pairs(law) do more[name] = value end
  more.channel = "water"
  return more
end
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("grid_conduction", with { low = low, high = high, cell = cell, density = density, conductivity = soaks * density })
scene:force("melt", with { viscosity = 0.01, solid = 1e5 })
scene:corrector("liquid", { low = low, high = high, cell = cell, density = density, viscosity_of = "melt" })

scene:measure("standing", function(s) -- part of the sand that is where it was, to half a cell
  local count = 0
  for k, id in ipairs(grains) do
    local p, q = s:position(id), sand.positions[k]
    local moved = math.max(math.abs(p[1] - q[1]), math.abs(p[2] - q[2]), math.abs(p[3] - q[3]))
    if moved < cell / 2 then count = count + 1 / #grains end
  end
  return count
end)
scene:measure("balance", function(s) -- kg: the content of all by their masses, which nothing but rounding changes
  local sum = 0
  for k, id in ipairs(ids) do sum = sum + (k > #sea.positions and sand.mass or sea.mass) * s:channel("water", id) end
  return sum
end, { unit = "kg" })
scene:output("frames", { surface = 0.3 * cell, surface_of = "sea", particles = "on", fade = "seen", color = "tint",
  radius = 0.32 * cell, obstacles = false, from = { 1.25, -0.85, 0.6 }, look_at = { 0.5, 0.16, 0.05 }, ground_height = 0, fov = 30 })
return scene
