-- sheet: triangulations of a unit square, { vertices =, faces = } for scene:mesh: squares of one diagonal each
-- (regular), of alternating diagonals, and irregular ones: rows of points, displaced at random, are joined to
-- Delaunay's triangulation by flips of edges (Lawson 1977) and smoothed, so that corners have five to seven triangles
-- of nearly equal sides.
local sheet = {}

local function squares(n, alternating)
  local vertices, faces = {}, {}
  for j = 0, n do
    for i = 0, n do vertices[#vertices + 1] = { i / n, j / n, 0 } end
  end
  for j = 0, n - 1 do
    for i = 0, n - 1 do
      local a = j * (n + 1) + i + 1
      local b, c, d = a + 1, a + n + 1, a + n + 2
      local back = alternating and (i + j) % 2 == 1
      faces[#faces + 1] = { a, b, back and c or d }
      faces[#faces + 1] = { back and b or a, d, c }
    end
  end
  return { vertices = vertices, faces = faces }
end

function sheet.regular(n) return squares(n, false) end

function sheet.alternating(n) return squares(n, true) end

-- A small generator of its own (splitmix64), so that a seed gives one mesh whatever else draws numbers.
local function random(seed)
  return function()
    seed = seed + 0x9e3779b97f4a7c15
    local z = (seed ~ (seed >> 30)) * 0xbf58476d1ce4e5b9
    z = (z ~ (z >> 27)) * 0x94d049bb133111eb
    return ((z ~ (z >> 31)) >> 11) / 2 ^ 53 * 2 - 1
  end
end

-- Rows of points a apart, every other one shifted by half of that; inner points displaced by up to `rough` of it.
local function rows_of_points(n, rough, draw)
  local vertices, rows, inner, count = {}, {}, {}, math.max(2, math.floor(n * 2 / math.sqrt(3) + 0.5))
  local function add(row, x, y, moves)
    if moves then x, y = x + rough / n * draw(), y + rough / n * draw() end
    vertices[#vertices + 1] = { x, y, 0 }
    row[#row + 1] = #vertices
    inner[#vertices] = moves
  end
  for j = 0, count do
    local row, y, edge = {}, j / count, j == 0 or j == count
    add(row, 0, y, false)
    for i = 1, n - 1 + j % 2 do add(row, (i - j % 2 / 2) / n, y, not edge) end
    add(row, 1, y, false)
    rows[#rows + 1] = row
  end
  return vertices, rows, inner
end

-- The triangles between two rows, from left to right: the point that is less far on comes first.
local function join_rows(vertices, low, high, faces)
  local i, j = 1, 1
  while i < #low or j < #high do
    local right = i < #low and (j == #high or vertices[low[i + 1]][1] < vertices[high[j + 1]][1])
    faces[#faces + 1] = { low[i], right and low[i + 1] or high[j + 1], high[j] }
    if right then i = i + 1 else j = j + 1 end
  end
end

local function cross(p, q, r) return (q[1] - p[1]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[1] - p[1]) end

local function cotangent(apex, p, q)
  return ((p[1] - apex[1]) * (q[1] - apex[1]) + (p[2] - apex[2]) * (q[2] - apex[2])) / math.abs(cross(apex, p, q))
end

-- The corner of a face behind the side from a to b, or nil.
local function opposite(face, a, b)
  for k = 1, 3 do
    if face[k] == a and face[k % 3 + 1] == b then return face[(k + 1) % 3 + 1] end
  end
end

-- One pass over all sides; returns how many were flipped: those whose opposite angles add up to more than pi.
local function flip(vertices, faces)
  local at, flips = {}, 0
  local function note(f)
    for k = 1, 3 do at[faces[f][k] * (#vertices + 1) + faces[f][k % 3 + 1]] = f end
  end
  for f = 1, #faces do note(f) end
  for f = 1, #faces do
    for k = 1, 3 do
      local a, b = faces[f][k], faces[f][k % 3 + 1]
      local c, g = opposite(faces[f], a, b), at[b * (#vertices + 1) + a]
      local d = g and opposite(faces[g], b, a)
      local v = vertices
      if d and cotangent(v[c], v[a], v[b]) + cotangent(v[d], v[a], v[b]) < -1e-9 and cross(v[c], v[a], v[d]) > 0
        and cross(v[d], v[b], v[c]) > 0 then
        faces[f], faces[g] = { c, a, d }, { d, b, c }
        note(f)
        note(g)
        flips = flips + 1
        break
      end
    end
  end
  return flips
end

-- Every inner point halfway to the mean of its neighbours.
local function smooth(vertices, faces, inner)
  local sum = {}
  for k = 1, #vertices do sum[k] = { 0, 0, 0 } end
  for _, face in ipairs(faces) do
    for k = 1, 3 do
      local s, p = sum[face[k]], vertices[face[k % 3 + 1]]
      s[1], s[2], s[3] = s[1] + p[1], s[2] + p[2], s[3] + 1
    end
  end
  for k, s in ipairs(sum) do
    if inner[k] then
      local p = vertices[k]
      vertices[k] = { (p[1] + s[1] / s[3]) / 2, (p[2] + s[2] / s[3]) / 2, 0 }
    end
  end
end

-- About n points along a side.
function sheet.irregular(n, seed)
  local vertices, rows, inner = rows_of_points(n, 0.45, random(seed or 1))
  local faces = {}
  for j = 1, #rows - 1 do join_rows(vertices, rows[j], rows[j + 1], faces) end
  for _ = 1, 5 do
    for _ = 1, 30 do
      if flip(vertices, faces) == 0 then break end
    end
    smooth(vertices, faces, inner)
  end
  return { vertices = vertices, faces = faces }
end

return sheet
