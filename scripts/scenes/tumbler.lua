-- tumbler.lua: a jet of water runs into a round glass, whose walls cut the grid's cells at every slope, beside its axis, so that it
-- sloshes round when the jet is off. What is in the glass has the volume that was there and has come in.
local filling = require("filling")
local shapes = require("shapes")
local cell = param("cell", 0.005, "of the grid, m", { min = 0.0025, max = 0.006 })
local flow = param("flow", 2e-4, "of the jet, m^3/s", { min = 5e-5, max = 4e-4 })
local off = param("off", 0.5, "when the jet is turned off, s", { min = 0.05, max = 1 })
local R, round, deep, wall, bottom, sides = 0.036, 0.03, 0.085, 0.013, 0.014, 48 -- m: within, its round part, depth; wall, floor
local jet, beside, spout, half, top = 0.011, 0.012, 0.125, 0.065, 0.14 -- m: radius of the jet, off the axis, its height; of the box

local function radius(z) -- m, within, at z above the floor: half an ellipsoid, and a tube above it
  return z < round and R * math.sqrt(math.max(0, 1 - (1 - z / round) ^ 2)) or R
end

-- From the foot up the outside, over the rim and down into it, with a point on the axis at either end.
local rings = { { 0.8 * R, 0 }, { R + wall, 0.5 * round }, { R + wall, bottom + deep } }
for _, z in ipairs { deep, 0.75 * deep, 0.5 * deep, round, 0.7 * round, 0.45 * round, 0.25 * round, 0.12 * round, 0.04 * round } do
  rings[#rings + 1] = { radius(z), bottom + z }
end
local glass = shapes.revolve(rings, sides)
local vertices, faces, last = glass.vertices, glass.faces, #glass.vertices - sides
local foot, pit = #vertices + 1, #vertices + 2
vertices[foot], vertices[pit] = { 0, 0, 0 }, { 0, 0, bottom }
for k = 1, sides do
  local next = k % sides + 1
  faces[#faces + 1], faces[#faces + 2] = { foot, next, k }, { last + k, last + next, pit }
end

local function flat(list)
  local all = {}
  for _, three in ipairs(list) do table.move(three, 1, 3, #all + 1, all) end
  return all
end

local scene = hooke.scene { duration = 1, fps = 20, dt = 0.4 * cell, integrator = "symplectic_euler" }
local water = filling.box { low = { -R, -R, bottom }, high = { R, R, bottom + 0.7 * round }, cell = cell, density = 1000,
  inside = function(x, y, z) return x * x + y * y < radius(z - bottom) ^ 2 end }
scene:particles { positions = water.positions, mass = water.mass, group = "water" }
local mass, speed = 1000 * (cell / 2) ^ 3, flow / (math.pi * jet ^ 2) -- kg, m/s
scene:source("emitter", { rate = 1000 * flow / mass, to = off, mass = mass, shape = "disc", extent = jet, speed = speed,
  position = { beside, 0, spout }, direction = { 0, 0, -1 }, places = "even", group = "water" })
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:corrector("obstacle", { shape = "mesh", vertices = flat(vertices), faces = flat(faces), restitution = 0, label = "glass" })
scene:corrector("liquid", { low = { -half, -half, 0 }, high = { half, half, top }, cell = cell, density = 1000 })

scene:measure("poured", function(s) return 1000 * s.n * mass end, { unit = "g" }) -- g, that is there
scene:measure("spilt", function(s) -- that is not in the glass or above it
  local sum = 0
  for _, id in ipairs(s:ids()) do
    local p = s:position(id)
    if math.sqrt(p[1] ^ 2 + p[2] ^ 2) > R * (1 + 1e-6) or p[3] < bottom - 1e-9 then sum = sum + 1000 * mass end
  end
  return sum
end, { unit = "g" })
scene:measure("middle", function(s) -- height of the water's centre of mass
  local sum = 0
  for _, id in ipairs(s:ids()) do sum = sum + s:position(id)[3] end
  return sum / s.n
end, { unit = "m" })
scene:output("frames", { surface = 0.35 * cell, surface_cell = 0.25 * cell, surface_of = "water", surface_look = "water",
  surface_absorption = { 12, 3, 1 }, color = "none", surface_cut = true, obstacle_opacity = 0.15,
  from = { 0.12, -0.44, 0.2 }, look_at = { 0, 0, 0.06 }, ground_height = 0, fov = 18 })
return scene
