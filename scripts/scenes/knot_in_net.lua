-- knot_in_net.lua: a trefoil, the torus knot (2, 3), of inflated cloth falls into a net of twine, which sags and holds it.
local drape = require("drape")
local twine = require("twine")
local n = param("n", 120, "particles along the knot", { min = 40, max = 1000 })
local around = param("around", 14, "particles around its tube", { min = 6, max = 100 })
local meshes = param("meshes", 8, "along each side of the net", { min = 2, max = 40 })
local radius = param("radius", 6e-3, "of the twine and thickness of the cloth, m", { min = 1e-4 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.5 })
twine.net(scene, { meshes = meshes, side = 1, height = 0.5, radius = radius, mass = 0.03, k = 300 })

-- On a torus about z: the normal of the torus is across the knot everywhere, and so is its product with the tangent.
local ring, winding, tube, height = 0.22, 0.1, 0.055, 0.75 -- m
local vertices, faces = {}, {}
for i = 0, n - 1 do
  local t = 2 * math.pi * i / n
  local c2, s2, c3, s3 = math.cos(2 * t), math.sin(2 * t), math.cos(3 * t), math.sin(3 * t)
  local rho = ring + winding * c3
  local out = { c3 * c2, c3 * s2, s3 }
  local along = { -3 * winding * s3 * c2 - 2 * rho * s2, -3 * winding * s3 * s2 + 2 * rho * c2, 3 * winding * c3 }
  local length = math.sqrt(along[1] ^ 2 + along[2] ^ 2 + along[3] ^ 2)
  local side = { (out[2] * along[3] - out[3] * along[2]) / length, (out[3] * along[1] - out[1] * along[3]) / length,
    (out[1] * along[2] - out[2] * along[1]) / length }
  for k = 0, around - 1 do
    local a = 2 * math.pi * (k + i % 2 / 2) / around
    local x, y = tube * math.cos(a), tube * math.sin(a)
    vertices[#vertices + 1] = { rho * c2 + x * out[1] + y * side[1], rho * s2 + x * out[2] + y * side[2],
      height + winding * s3 + x * out[3] + y * side[3] }
    local odd, right, next_ring = i % 2, (k + 1) % around, (i + 1) % n * around
    local p, q, b, c = i * around + k + 1, i * around + right + 1, next_ring + k + 1, next_ring + right + 1
    faces[#faces + 1] = odd == 0 and { p, b, q } or { p, b, c }
    faces[#faces + 1] = odd == 0 and { q, b, c } or { p, c, q }
  end
end
local knot = scene:mesh { vertices = vertices, faces = faces, mass = 0.35, group = "knot" }
scene:force("springs", { edges = knot:edges(), k = 300, damping = 0.05, label = "cloth" })
scene:force("volume", { triangles = knot:triangles(), k = 2e4, damping = 20, label = "air" })
scene:force("drag", { rate = 1 })
drape.contact(scene, contact, { radius = radius, thickness = radius, friction = 0.3 })

scene:measure("lowest", drape.lowest(knot:ids()), { unit = "m" })
scene:output("frames", { color = "group", thickness = radius, particles = "off",
  from = { 1.1, -1.8, 1.3 }, look_at = { 0, 0, 0.4 }, fov = 27, ground_height = -0.1 })
return scene
