-- funnel.lua: a ribbon of cloth is drawn by the middle of its lower edge through a funnel that is narrower than the
-- ribbon: it folds up lengthwise, slips through the neck, and opens again below.
local drape, shapes = require("drape"), require("shapes")
local N = param("N", 13, "particles across the ribbon", { min = 5, max = 128 })
local thickness = param("thickness", 4e-3, "of the cloth in contact, m", { min = 1e-5 })
local friction = param("friction", 0.1, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier")

local scene = drape.scene(contact, { duration = 2 })
shapes.hold(scene, shapes.revolve({ { 0.3, 0.24 }, { 0.22, 0.16 }, { 0.14, 0.08 }, { 0.075, 0.02 }, { 0.06, -0.02 },
  { 0.06, -0.1 } }, 40))
local M = 2 * (N - 1) + 1
local cloth = drape.sheet(scene, { nx = N, ny = M, width = 0.3, height = 0.6, origin = { -0.15, 0.003, 0.2 },
  stiffness = 150, u = { 1, 0, 0 }, v = { 0, 0, 1 } })
local middle = (N + 1) // 2
scene:pin({ cloth:at(middle, 1) }, { path = function(t) return 0, 0, -0.45 * t end })
scene:force("drag", { rate = 2 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

scene:measure("width of the ribbon halfway up", function(s)
  local a, b = s:position(cloth:at(1, N)), s:position(cloth:at(N, N))
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end)
scene:output("frames", { color = "none", thickness = thickness, particles = "off", camera = { 0.9, -1.7, 0.95 },
  target = { 0, 0, 0 }, fov = 32, ground_height = -0.8 })
return scene
