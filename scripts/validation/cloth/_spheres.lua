-- Spheres of triangles, and the balloon of rubber that they are made: incompressible and neo-Hookean, mu the shear modulus
-- times the thickness at rest, the radius R at rest, s times that when it is inflated.
local spheres = {}

-- Corners and triangles of an icosahedron.
local function icosahedron()
  local g, vertices, faces = (1 + math.sqrt(5)) / 2, {}, {}
  for _, a in ipairs { -1, 1 } do
    for _, b in ipairs { -g, g } do
      for turn = 0, 2 do
        local p = { 0, a, b }
        vertices[#vertices + 1] = { p[(3 - turn) % 3 + 1], p[(4 - turn) % 3 + 1], p[(5 - turn) % 3 + 1] }
      end
    end
  end
  local function near(p, q) return (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2 < 4.1 end
  for i = 1, 12 do
    for j = i + 1, 12 do
      for k = j + 1, 12 do
        local p, q, r = vertices[i], vertices[j], vertices[k]
        if near(p, q) and near(q, r) and near(r, p) then
          local out = p[1] * (q[2] * r[3] - q[3] * r[2]) + p[2] * (q[3] * r[1] - q[1] * r[3]) + p[3] * (q[1] * r[2] - q[2] * r[1])
          faces[#faces + 1] = out > 0 and { p, q, r } or { p, r, q }
        end
      end
    end
  end
  return faces
end

-- Its edges divided into n, all corners on the sphere of radius R: corners and triangles.
function spheres.add(n, R)
  local vertices, faces, known = {}, {}, {}
  local function corner(p, q, r, i, j)
    local x, size = {}, 0
    for c = 1, 3 do
      x[c] = ((n - i - j) * p[c] + i * q[c] + j * r[c]) / n
      size = size + x[c] ^ 2
    end
    for c = 1, 3 do x[c] = R * x[c] / math.sqrt(size) end
    local name = ("%.6f %.6f %.6f"):format(x[1] + 1, x[2] + 1, x[3] + 1)
    if not known[name] then vertices[#vertices + 1], known[name] = x, #vertices + 1 end
    return known[name]
  end
  for _, f in ipairs(icosahedron()) do
    for i = 0, n - 1 do
      for j = 0, n - 1 - i do
        local function at(k, l) return corner(f[1], f[2], f[3], k, l) end
        faces[#faces + 1] = { at(i, j), at(i + 1, j), at(i, j + 1) }
        if i + j < n - 1 then faces[#faces + 1] = { at(i + 1, j), at(i + 1, j + 1), at(i, j + 1) } end
      end
    end
  end
  return vertices, faces
end

function spheres.volume(x, faces)
  local sum = 0
  for _, f in ipairs(faces) do
    local p, q, r = x[f[1]], x[f[2]], x[f[3]]
    sum = sum + p[1] * (q[2] * r[3] - q[3] * r[2]) + p[2] * (q[3] * r[1] - q[1] * r[3]) + p[3] * (q[1] * r[2] - q[2] * r[1])
  end
  return sum / 6
end

-- Green and Adkins 1960: largest at s = 7^(1/6), and falling from there on.
function spheres.pressure(mu, R, s) return 2 * mu / R * (1 / s - 1 / s ^ 7) end

return spheres
