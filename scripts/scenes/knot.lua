-- knot.lua: an overhand knot in a rope is pulled tight by both ends. The rope meets itself and cannot pass, so the knot
-- holds, as small as the rope's radius and bending stiffness let it be.
local drape = require("drape")
local n = param("n", 121, "particles", { min = 20, max = 5000 })
local radius = param("radius", 0.01, "of the rope, m", { min = 1e-4 })
local friction = param("friction", 0.2, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 2 })
-- Shastri's trefoil, (t^3 - 3t, t^4 - 4t^2, t^5 - 10t), laid down flatter.
local rope = scene:strand { n = n, mass = 0.2, curve = function(s)
  local t = 4.3 * s - 2.15
  return 0.022 * (t ^ 5 - 10 * t), 0.065 * (t ^ 3 - 3 * t), 0.065 * (t ^ 4 - 4 * t ^ 2) + 0.4
end }
scene:force("springs", { edges = rope:edges(), k = 2000, damping = 0.2, label = "rope" })
scene:force("angle_springs", { edges = rope:edges(), k = 0.15, damping = 1e-3, rest = 0 })
for k, at in pairs { [-1] = 1, [1] = n } do
  scene:pin({ rope:at(at) }, { path = function(t) return 0.28 * k * t, 0, 0 end })
end
scene:force("drag", { rate = 3 })
drape.contact(scene, contact, { radius = radius, friction = friction })

scene:measure("strain", function(s) return s:strain("rope") end)
scene:output("frames", { color = "none", particles = "off", plain = { 0.85, 0.7, 0.45 }, from = { 0.15, -1.9, 0.55 },
  look_at = { 0, 0, 0.12 }, fov = 24, ground_height = -0.4 })
return scene
