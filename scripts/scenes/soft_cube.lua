-- soft_cube.lua: a soft cube is dropped onto a slope of tan a = 1/2. With mu = 0.3 it wobbles, slides down and comes to
-- rest on the floor; with mu = 0.55 it stays where it has calmed down. Nothing passes through anything: that is counted.
local drape = require("drape")
local mu = param("mu", 0.3, "friction; more than 0.5 holds", { min = 0 })
local n = param("n", 5, "particles along an edge", { min = 2, max = 40 })
local E = param("E", 1e5, "Young's modulus, Pa", { min = 1000 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local size, a = 0.5, math.atan(1 / 2)
local down, off = { math.cos(a), 0, -math.sin(a) }, { math.sin(a), 0, math.cos(a) }
local function at(s, height) -- on the slope, which begins at (0, 0, 1)
  return { s * down[1] + height * off[1], 0, 1 + s * down[3] + height * off[3] }
end

local scene = drape.scene(contact, { duration = 3, dt = 5e-4 })
local place = at(0.15, 0.03)
local cube = scene:block { nx = n, ny = n, nz = n, size = { size, size, size }, density = 1000,
  origin = { place[1], -size / 2, place[3] }, u = down }
scene:body { shape = "box", size = { 2.2, 1.2, 0.06 }, position = at(1.1, -0.03), orientation = { 0, a, 0 } }
scene:body { shape = "box", size = { 3, 1.2, 0.06 }, position = { 2.6, 0, -0.03 } }

scene:force("neo_hookean", { tetrahedra = cube:tetrahedra(), E = E, nu = 0.4, damping = 0.001 * E })
drape.contact(scene, contact, { thickness = 1e-3, friction = mu, leave = cube:inside(), stiffness = 1e9 })

local middle = cube:at((n + 1) // 2, (n + 1) // 2, (n + 1) // 2)
scene:measure("way along the slope", function(s)
  local x, from = s:position(middle), at(0.15 + size / 2, 0.03 + size / 2)
  return (x[1] - from[1]) * down[1] + (x[3] - from[3]) * down[3]
end, { unit = "m" })
scene:output("frames", { width = 1280, height = 720, ground_height = -0.06 })
return scene
