-- shapes: bodies that scene:body does not know, as vertices and faces for scene:mesh: surfaces of revolution about z,
-- such as funnels. They are given to `hold` to become bodies: pinned as a whole.
local shapes = {}

-- `profile`: points { r, z } with r > 0; the surface is open at both ends.
function shapes.revolve(profile, sides)
  local vertices, faces = {}, {}
  for _, p in ipairs(profile) do
    for k = 1, sides do
      local a = 2 * math.pi * k / sides
      vertices[#vertices + 1] = { p[1] * math.cos(a), p[1] * math.sin(a), p[2] }
    end
  end
  for j = 0, #profile - 2 do
    for k = 1, sides do
      local a, b = j * sides + k, j * sides + k % sides + 1
      faces[#faces + 1] = { a, b, b + sides }
      faces[#faces + 1] = { a, b + sides, a + sides }
    end
  end
  return { vertices = vertices, faces = faces }
end

-- Enters the shape, which no force moves; `pin`: path and rotation, as scene:pin takes them.
function shapes.hold(scene, shape, pin)
  local mesh = scene:mesh { vertices = shape.vertices, faces = shape.faces, mass = 1 }
  if pin then scene:pin(mesh:ids(), pin) else scene:pin(mesh:ids()) end
  return mesh
end

return shapes
