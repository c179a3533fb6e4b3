-- hair_on_shoulder.lua: hair grows on a head, falls over its back and shoulders, and lies on them. Strands touch the
-- bodies and each other, as thick as `radius`, and none passes through.
local drape = require("drape")
local S = param("strands", 100, "how many", { min = 1, max = 5000 })
local n = param("n", 18, "particles of each", { min = 4, max = 500 })
local radius = param("radius", 2e-3, "of a strand in contact, m", { min = 1e-5 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.2 })
scene:body { shape = "sphere", radius = 0.1, position = { 0, 0, 0 }, detail = 6e-3 }
scene:body { shape = "capsule", radius = 0.085, length = 0.56, position = { 0, 0.02, -0.22 }, detail = 6e-3,
  orientation = { 0, math.pi / 2, 0 } }
-- Strands begin on a cap of a sphere that is a little larger than the head.
local hair = scene:hair { on = { centre = { 0, 0, 0 }, radius = 0.1 + 2 * radius, cap = 1.35, axis = { 0, -0.25, 1 } },
  strands = S, n = n, length = 0.34, spread = 0.02, seed = 3, radius = 1e-3, E = 4e6, nu = 0.4, density = 1100,
  clamped = false }
local roots, ids = {}, hair:ids()
for k = 1, S do roots[k] = hair:at(1, k) end
scene:pin(roots)
scene:force("springs", { edges = hair:edges(), k = 20, damping = 2e-3, label = "stretch" })
scene:force("angle_springs", { edges = hair:edges(), EI = hair.EI, retardation = 2e-2 })
scene:force("drag", { rate = 4 })
drape.contact(scene, contact, { radius = radius, thickness = radius, friction = 0.2 })

scene:measure("lowest", drape.lowest(ids), { unit = "m" })
scene:output("frames", { color = "none", plain = { 0.45, 0.28, 0.16 }, particles = "off",
  from = { 0.55, -1.05, 0.3 }, look_at = { 0, 0, -0.12 }, fov = 28, ground = false })
return scene
