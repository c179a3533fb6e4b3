-- What the problems about membranes of triangles share.
local sheet = require("sheet")

local triangles = { kinds = { "regular", "alternating", "irregular" } }

-- The unit square as a mesh of a kind, whose corners start at place(x, y), at rest in the square: handle, list of corners
-- in the square, and the parameters `triangles` and `uv` of the force.
function triangles.add(scene, kind, n, place, options)
  local shape, start, uv = sheet[kind](n), {}, {}
  for k, p in ipairs(shape.vertices) do start[k] = { place(p[1], p[2]) } end
  for _, face in ipairs(shape.faces) do
    for _, corner in ipairs(face) do
      uv[#uv + 1] = shape.vertices[corner][1]
      uv[#uv + 1] = shape.vertices[corner][2]
    end
  end
  local masses = {}
  for k = 1, #start do masses[k] = 0 end
  for _, f in ipairs(shape.faces) do
    local a, b, c = shape.vertices[f[1]], shape.vertices[f[2]], shape.vertices[f[3]]
    local area = math.abs((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])) / 2
    for _, corner in ipairs(f) do masses[corner] = masses[corner] + (options.density or 1) * area / 3 end
  end
  local cloth = scene:particles { positions = start, masses = masses }
  local ids, faces = cloth:ids(), {}
  for k, f in ipairs(shape.faces) do faces[k] = { ids[f[1]], ids[f[2]], ids[f[3]] } end
  return ids, shape.vertices, faces, uv
end

-- The ids of the corners where which(x, y) holds.
function triangles.where(ids, corners, which)
  local list = {}
  for k, p in ipairs(corners) do
    if which(p[1], p[2]) then list[#list + 1] = ids[k] end
  end
  return list
end

return triangles
