-- net.lua: balls fall into a net of knotted twine that hangs by its rim. It sags, catches them, and they gather in its
-- middle; no ball slips past a thread.
local drape = require("drape")
local n = param("meshes", 9, "along each side of the net", { min = 2, max = 40 })
local balls = param("balls", 5, "how many fall", { min = 0, max = 50 })
local radius = param("radius", 6e-3, "of the twine, m", { min = 1e-4 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.5 })
local per, side = 3, 1 -- edges per mesh
local function twine(k, along)
  local at = side * (k / n - 0.5)
  local function point(s, z) return along and { s, at, z } or { at, s, z } end
  return scene:strand { n = per * n + 1, mass = 0.03, group = along and "weft" or "warp",
    from = point(-side / 2, along and 0.5 or 0.5 + 2.2 * radius), to = point(side / 2, along and 0.5 or 0.5 + 2.2 * radius) }
end
local warp, weft, edges, knots, rim = {}, {}, nil, {}, {}
for k = 0, n do
  weft[k], warp[k] = twine(k, true), twine(k, false)
  for _, thread in ipairs { weft[k], warp[k] } do
    edges = edges and edges .. thread:edges() or thread:edges()
    rim[#rim + 1], rim[#rim + 2] = thread:at(1), thread:at(per * n + 1)
  end
end
for i = 0, n do
  for j = 0, n do knots[#knots + 1] = { weft[j]:at(per * i + 1), warp[i]:at(per * j + 1) } end
end
scene:pin(rim)
scene:force("springs", { edges = edges, k = 600, damping = 0.1, label = "twine" })
scene:force("springs", { edges = knots, k = 600, damping = 0.1, label = "knots" })
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
end)
scene:output("frames", { color = "group", thickness = radius, particles = "off",
  from = { 1.1, -1.8, 1.2 }, look_at = { 0, 0, 0.42 }, fov = 32, ground_height = -0.1 })
return scene
