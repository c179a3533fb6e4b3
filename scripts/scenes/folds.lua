-- folds.lua: a ribbon of cloth is let go on end above the floor and lays itself down in folds, layer on layer. The
-- thickness of the cloth holds the layers apart, so the pile has a height.
local drape = require("drape")
local N = param("N", 9, "particles across the ribbon", { min = 3, max = 256 })
local thickness = param("thickness", 5e-3, "of the cloth in contact, m", { min = 1e-5 })
local friction = param("friction", 0.4, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.5 })
scene:body { shape = "plane", size = 1.6 }
local cloth = drape.sheet(scene, { nx = N, ny = 8 * (N - 1) + 1, width = 0.16, height = 1.28, rigidity = 1e-4,
  origin = { -0.08, 0, 0.01 }, u = { 1, 0, 0 }, v = { 0, 0.06, 1 }, bend_damping = 4e-6 })
scene:force("drag", { rate = 1.5 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

scene:measure("height of the pile", function(s)
  local z = 0
  for _, i in ipairs(cloth:ids()) do z = math.max(z, s:position(i)[3]) end
  return z
end, { unit = "m" })
scene:output("frames", { color = "none", plain = { 0.85, 0.55, 0.3 }, thickness = thickness, from = { 1.0, -0.9, 0.5 },
  look_at = { 0, 0.06, 0.06 }, fov = 15, ground_height = 0 })
return scene
