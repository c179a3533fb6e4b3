-- harbour.lua: a raft, a log, a cork and a stone are let go over a basin: the raft and the log float, the cork bobs, the stone
-- sinks. A spout fills the basin and a drain empties it; bodies and water move each other.
local filling = require("filling")
local cell = param("cell", 0.05, "of the grid, m", { min = 0.02, max = 0.1 })
local drop = param("drop", 0.06, "of the bodies, m", { min = 0, max = 0.2 })
local inflow = param("inflow", 20, "of the spout, kg/s", { min = 0, max = 100 })
local outflow = param("outflow", 5, "of the drain, kg/s", { min = 0, max = 100 })
local high, level = { 1.6, 0.8, 0.8 }, 0.4 -- m: of the basin; of the water

local scene = hooke.scene { duration = 3, fps = 30, dt = 0.16 * cell, integrator = "symplectic_euler" }
local water = filling.box { low = { 0, 0, 0 }, high = { high[1], high[2], level }, cell = cell, density = 1000 }
scene:particles { positions = water.positions, mass = water.mass, group = "water" }
scene:source("emitter", { rate = inflow / water.mass, mass = water.mass, shape = "disc", extent = 0.06, speed = 1,
  position = { 0.12, 0.4, 0.7 }, direction = { 0.3, 0, -1 }, group = "water" })
scene:source("drain", { low = { 1.4, 0, 0 }, high = { high[1], high[2], 0.1 }, rate = outflow })

local z = level + drop
local raft = scene:rigid { shape = "box", size = { 0.4, 0.4, 0.12 }, density = 500, position = { 0.6, 0.4, z + 0.06 } }
local log = scene:rigid { shape = "cylinder", radius = 0.09, length = 0.5, density = 600, position = { 1.1, 0.4, z + 0.09 },
  orientation = { math.pi / 2, 0, 0 } }
local cork = scene:rigid { shape = "sphere", radius = 0.08, density = 200, position = { 1.38, 0.22, z + 0.08 } }
local stone = scene:rigid { shape = "sphere", radius = 0.09, density = 2500, position = { 1.4, 0.58, z + 0.1 } }
scene:force("gravity", { g = { 0, 0, -9.81 } })
for _, body in ipairs { raft, log, cork, stone } do body:surface() end
filling.tank(scene, { 0, 0, 0 }, high)
scene:corrector("liquid", { low = { 0, 0, 0 }, high = high, cell = cell, density = 1000 })

scene:measure("mass", function(s) -- of the water, kg
  local sum = -raft.mass - log.mass - cork.mass - stone.mass
  for _, id in ipairs(s:ids()) do sum = sum + s:mass(id) end
  return sum
end, { unit = "kg" })
for k, name in ipairs { "raft", "log", "cork", "stone" } do
  local body = ({ raft, log, cork, stone })[k]
  scene:measure(name, function(s) return body:position(s)[3] end, { unit = "m" }) -- its height
end
scene:output("frames", { surface = 0.4 * cell, surface_of = "water", surface_look = "water", surface_absorption = { 4, 1.2, 0.5 },
  plain = { 0.72, 0.5, 0.3 }, color = "none", springs = "off", surface_cut = true,
  obstacles = false, from = { 2.3, -1.5, 1.7 }, look_at = { 0.8, 0.4, 0.3 }, ground_height = 0 })
return scene
