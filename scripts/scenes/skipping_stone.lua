-- skipping_stone.lua: a flat stone that spins is thrown over water, its front up by `tilt`: fast enough, it skips; slow, it
-- sinks (speed=2). Rosellini, Hersen, Clanet, Bocquet 2005, Skipping stones, J. Fluid Mech. 543: 20 degrees take the least
-- speed. Leapfrog keeps the spin, and the step is short against a turn.
local filling = require("filling")
local cell = param("cell", 0.03, "of the grid, m", { min = 0.01, max = 0.05 })
local speed = param("speed", 8, "of the stone, forwards, m/s", { min = 0, max = 20 })
local fall = param("fall", 1, "of the stone, downwards, m/s", { min = 0, max = 5 })
local tilt = param("tilt", 20, "of the stone, degrees", { min = 0, max = 60 })
local spin = param("spin", 40, "of the stone about its axis, rad/s", { min = 0, max = 100 })
local high, level = { 2.7, 0.5, 0.5 }, 0.125 -- m: of the basin; of the water
local radius, thick = 0.1, 0.05 -- m: of the stone

local scene = hooke.scene { duration = 0.35, fps = 20, dt = 0.002, integrator = "leapfrog" }
local water = filling.box { low = { 0, 0, 0 }, high = { high[1], high[2], level }, cell = cell, density = 1000 }
scene:particles { positions = water.positions, mass = water.mass, group = "water" }
local a = math.rad(tilt)
local stone = scene:rigid { shape = "cylinder", radius = radius, length = thick, density = 1800,
  position = { 0.25, high[2] / 2, level + radius * math.sin(a) + 0.04 }, orientation = { 0, -a, 0 },
  velocity = { speed, 0, -fall }, spin = { -spin * math.sin(a), 0, spin * math.cos(a) } }
stone:surface()
scene:force("gravity", { g = { 0, 0, -9.81 } })
filling.tank(scene, { 0, 0, 0 }, high)
scene:corrector("liquid", { low = { 0, 0, 0 }, high = high, cell = cell, density = 1000 })

scene:measure("height", function(s) return stone:position(s)[3] - level end, { unit = "m" }) -- above the water
scene:measure("way", function(s) return stone:position(s)[1] end, { unit = "m" })
local lowest, hop = math.huge, 0
scene:measure("hop", function(s) -- how far it has come up again
  local z = stone:position(s)[3]
  lowest, hop = math.min(lowest, z), math.max(hop, z - lowest)
  return hop
end, { unit = "m" })
scene:output("frames", { surface = 0.4 * cell, surface_cell = 0.4 * cell, surface_of = "water", surface_look = "water",
  surface_absorption = { 4, 1.2, 0.5 }, plain = { 0.4, 0.4, 0.42 }, color = "none", springs = "off", surface_cut = true, obstacles = false,
  width = 1280, height = 400, from = { 1.4, -2.9, 0.95 }, look_at = { 1.35, 0.25, 0.16 }, fov = 17, ground_height = 0 })
return scene
