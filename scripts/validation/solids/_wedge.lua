-- A ball that does the same all around the axis z, as a thin wedge of its upper half: one layer of tetrahedra between two
-- planes through the axis, on which its particles slide. They are small at the pole.
local wedge = {}

-- n cells along the radius and n along the axis of a ball of radius R, n^-grading R of size at the pole. Returns the
-- handle, the particles of the equator, and those at the pole's side of the sphere.
function wedge.add(scene, n, R, angle, grading, density)
  local vertices, tetrahedra, pins, ids = {}, {}, {}, {}
  local function id(i, j, side) return ids[((i == 0 and 0 or side) * (n + 1) + j) * (n + 1) + i] end
  for side = 0, 1 do
    local turn = (side - 0.5) * angle
    for j = 0, n do
      for i = side, n do
        local u, w = (i / n) ^ grading, 1 - (1 - j / n) ^ grading
        local r, z = R * u * math.sqrt(1 - w * w / 2), R * w * math.sqrt(1 - u * u / 2) -- the square onto the quarter disc
        vertices[#vertices + 1] = { r * math.cos(turn), r * math.sin(turn), z }
        ids[(side * (n + 1) + j) * (n + 1) + i] = #vertices
        pins[#vertices] = i == 0 and (j > 0 and { axes = { 0, 0, 1 } } or {})
          or j == 0 and { axes = { math.cos(turn), math.sin(turn), 0 } } or { normal = { -math.sin(turn), math.cos(turn), 0 } }
      end
    end
  end
  local orders = { { 1, 2, 3 }, { 2, 3, 1 }, { 3, 1, 2 }, { 2, 1, 3 }, { 1, 3, 2 }, { 3, 2, 1 } } -- Kuhn's six of a cell
  for i = 0, n - 1 do
    for j = 0, n - 1 do
      for o, order in ipairs(orders) do
        local corner, t, all = { i, 0, j }, { id(i, j, 0) }, true
        for m = 1, 3 do
          corner[order[m]] = corner[order[m]] + 1
          t[m + 1] = id(corner[1], corner[3], corner[2])
          all = all and t[m + 1] ~= t[m] -- two corners on the axis are one
        end
        if o > 3 then t[3], t[4] = t[4], t[3] end
        if all then tetrahedra[#tetrahedra + 1] = t end
      end
    end
  end
  local body = scene:tetrahedra { vertices = vertices, tetrahedra = tetrahedra, density = density }
  local equator = {}
  for k, pin in ipairs(pins) do
    if next(pin) then scene:pin({ body:at(k) }, pin) else scene:pin { body:at(k) } end
    if math.abs(vertices[k][3]) < 1e-12 then equator[#equator + 1] = body:at(k) end
  end
  return body, equator
end

return wedge
