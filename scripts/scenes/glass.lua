-- glass.lua: a jet of water fills a thick square glass, in which there is a little, and is turned off before it overflows; what is in
-- it then has the volume that was there and has come in. The emitter's `places = "even"` lets the jet come in with the density of water.
local filling = require("filling")
local cell = param("cell", 0.005, "of the grid, m", { min = 0.002, max = 0.005 })
local fill = param("fill", 0.35, "of the glass that comes in, by its volume", { min = 0.05, max = 1.3 })
local speed = param("speed", 0.8, "of the jet, where it comes in, m/s", { min = 0.2, max = 3 })
local inner, wall, deep, bottom = 0.03, 0.015, 0.08, 0.015 -- m: of the glass, half its width within, wall, depth, floor
local jet, spout, off = 0.012, 0.12, 0.008 -- m: its radius, its height, beside the axis
local half, top, first = 0.06, 0.14, 0.02 -- m: of the box; of the water that is there at first

local scene = hooke.scene { duration = 0.9, fps = 10, dt = 0.4 * cell, integrator = "symplectic_euler" }
local mass, flow = 1000 * (cell / 2) ^ 3, math.pi * jet ^ 2 * speed -- kg, m^3/s
local volume = 4 * inner ^ 2 * deep
local water = filling.box { low = { -inner, -inner, bottom }, high = { inner, inner, bottom + first }, cell = cell, density = 1000 }
scene:particles { positions = water.positions, mass = water.mass, group = "water" }
scene:source("emitter", { rate = 1000 * flow / mass, to = fill * volume / flow, mass = mass, shape = "disc", extent = jet,
  speed = speed, position = { off, 0, spout }, direction = { 0, 0, -1 }, places = "even", group = "water" })
scene:force("gravity", { g = { 0, 0, -9.81 } })

-- Its four sides and its floor are boxes, three cells thick, that fit the grid. They overlap and reach into the table, so that
-- from within each of them the nearest way out is one into the air.
local middle, whole, under = inner + wall / 2, 2 * (inner + wall), 0.02
local function box(name, x, y, size_x, size_y, height)
  scene:corrector("obstacle", { shape = "box", size = { size_x, size_y, height + under }, restitution = 0, label = name,
    position = { x, y, (height - under) / 2 } })
end
box("west", -middle, 0, wall, whole, bottom + deep)
box("east", middle, 0, wall, whole, bottom + deep)
box("south", 0, -middle, whole, wall, bottom + deep)
box("north", 0, middle, whole, wall, bottom + deep)
box("floor", 0, 0, whole, whole, bottom)
scene:corrector("liquid", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = 1000 })

scene:measure("filled", function(s) -- of the glass, by the mass of the water in it
  local sum = 0
  for _, id in ipairs(s:ids()) do
    local p = s:position(id)
    if math.max(math.abs(p[1]), math.abs(p[2])) < middle and p[3] < bottom + deep then sum = sum + s:mass(id) end
  end
  return sum / (1000 * volume)
end)
scene:measure("spilt", function(s) -- beside the glass
  local sum = 0
  for _, id in ipairs(s:ids()) do
    local p = s:position(id)
    if math.max(math.abs(p[1]), math.abs(p[2])) > middle then sum = sum + s:mass(id) end
  end
  return sum
end, { unit = "kg" })
scene:output("frames", { surface = 0.35 * cell, surface_cell = 0.25 * cell, surface_of = "water", surface_look = "water",
  surface_absorption = { 12, 3, 1 }, color = "none", surface_cut = true, obstacle_opacity = 0.15,
  from = { 0.12, -0.44, 0.2 }, look_at = { 0, 0, 0.06 }, ground_height = 0, fov = 18 })
return scene
