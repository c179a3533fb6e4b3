-- funnel.lua: a ribbon of cloth is drawn by the middle of its lower edge through a funnel that is narrower than the
-- ribbon; its upper edge follows at the same speed. It folds up lengthwise, slips through the neck, and opens again below.
local drape, shapes = require("drape"), require("shapes")
local N = param("N", 11, "particles across the ribbon", { min = 5, max = 128 })
local thickness = param("thickness", 4e-3, "of the cloth in contact, m", { min = 1e-5 })
local friction = param("friction", 0.1, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 2 })
shapes.hold(scene, shapes.revolve({ { 0.3, 0.24 }, { 0.22, 0.16 }, { 0.14, 0.08 }, { 0.075, 0.02 }, { 0.06, -0.02 },
  { 0.06, -0.1 } }, 40))
local M = 3 * (N - 1) + 1
local cloth = drape.sheet(scene, { nx = N, ny = M, width = 0.3, height = 0.9, origin = { -0.15, 0.003, 0.2 },
  stiffness = 150, u = { 1, 0, 0 }, v = { 0, 0, 1 } })
local upper = {}
for i = 1, N do upper[i] = cloth:at(i, M) end
local function down(t) return 0, 0, -0.4 * (t < 0.2 and t * t / 0.4 or t - 0.1) end
scene:pin({ cloth:at((N + 1) // 2, 1) }, { path = down })
scene:pin(upper, { path = down, release = 1.9 })
scene:force("drag", { rate = 2 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

scene:measure("width of the ribbon halfway up", function(s)
  local a, b = s:position(cloth:at(1, M // 2)), s:position(cloth:at(N, M // 2))
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end, { unit = "m" })
scene:output("frames", { color = "none", plain = { 0.8, 0.6, 0.25 }, thickness = thickness, particles = "off",
  from = { 0.8, -2.0, 1.0 }, look_at = { 0, 0, 0.08 }, fov = 36, ground_height = -0.85 })
return scene
