-- net.lua: balls fall into a net of knotted twine that hangs by its rim. It sags, catches them, and they gather in its
-- middle; no ball slips past a thread.
local drape = require("drape")
local twine = require("twine")
local n = param("meshes", 9, "along each side of the net", { min = 2, max = 40 })
local balls = param("balls", 5, "how many fall", { min = 0, max = 50 })
local radius = param("radius", 6e-3, "of the twine, m", { min = 1e-4 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.5 })
twine.net(scene, { meshes = n, side = 1, height = 0.5, radius = radius, mass = 0.03, k = 600 })
for k = 1, balls do
  local a = 2.4 * k -- the golden angle: balls are spread evenly
  local ball = scene:body { shape = "sphere", radius = 0.1, detail = 2e-2, mass = 0.12, group = "balls",
    position = { 0.07 * math.sqrt(k) * math.cos(a), 0.07 * math.sqrt(k) * math.sin(a), 0.5 + 0.24 * k } }
  scene:force("springs", { edges = ball:edges(), k = 600, damping = 0.1, label = "ball " .. k })
  scene:force("volume", { triangles = ball:triangles(), k = 2e4, damping = 20, label = "air in ball " .. k })
end
scene:force("drag", { rate = 1 })
drape.contact(scene, contact, { radius = radius, thickness = radius, friction = 0.3 })

scene:measure("lowest", function(s)
  local z = 1
  for _, i in ipairs(s:ids()) do z = math.min(z, s:position(i)[3]) end
  return z
end, { unit = "m" })
scene:output("frames", { color = "group", thickness = radius, particles = "off",
  from = { 1.1, -1.8, 1.2 }, look_at = { 0, 0, 0.42 }, fov = 32, ground_height = -0.1 })
return scene
