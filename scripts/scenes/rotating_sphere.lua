-- rotating_sphere.lua: cloth lies over a ball on the floor. The ball begins to turn about the vertical and takes the
-- cloth along by friction alone: it winds itself up in spiral folds. friction=0 lets the ball turn below.
local drape = require("drape")
local N = param("N", 41, "particles along one side", { min = 3, max = 512 })
local thickness = param("thickness", 4e-3, "of the cloth in contact, m", { min = 1e-5 })
local friction = param("friction", 0.6, "Coulomb's mu", { min = 0 })
local speed = param("speed", 6, "of the ball from 0.6 s on, rad/s")
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 2 })
scene:body { shape = "sphere", radius = 0.22, position = { 0, 0, 0.23 }, detail = 3e-3, rotation = function(t)
  local since = math.max(0, t - 0.6)
  return 0, 0, since < 0.5 and speed * since ^ 2 or speed * (since - 0.25)
end }
scene:body { shape = "plane", size = 3 }
local cloth = drape.sheet(scene, { nx = N, ny = N, width = 1, height = 1, origin = { -0.5, -0.5, 0.47 },
  u = { 1, 0, 0 }, v = { 0, 1, 0 } })
scene:force("drag", { rate = 1 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

local corner = cloth:at(1, 1)
scene:measure("turn of the corner, rad", function(s)
  local p = s:position(corner)
  return math.atan(p[2], p[1]) + 3 * math.pi / 4
end)
scene:output("frames", { color = "none", thickness = thickness, from = { 0.9, -1.7, 1.1 }, look_at = { 0, 0, 0.15 },
  fov = 28, ground_height = 0 })
return scene
