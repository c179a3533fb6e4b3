-- Meshes of implicit surfaces against closed forms: area, volume, the angle between facets and surface, Euler's number,
-- and edges that are not in exactly two triangles of opposite direction, by both methods; the volume of the filling.
local validation = require("validation")

local surfaces = {}

local function corner(m, k) return m.vertices[3 * k - 2], m.vertices[3 * k - 1], m.vertices[3 * k] end

-- Area, volume, and the area's mean square of the sine between each facet and the surface at its middle.
local function measure(m, gradient)
  local area, volume, bent = 0, 0, 0
  for t = 1, #m.faces, 3 do
    local ax, ay, az = corner(m, m.faces[t])
    local bx, by, bz = corner(m, m.faces[t + 1])
    local cx, cy, cz = corner(m, m.faces[t + 2])
    local ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    local nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    local gx, gy, gz = gradient((ax + bx + cx) / 3, (ay + by + cy) / 3, (az + bz + cz) / 3)
    local n, g = math.sqrt(nx * nx + ny * ny + nz * nz), math.sqrt(gx * gx + gy * gy + gz * gz)
    local kx, ky, kz = ny * gz - nz * gy, nz * gx - nx * gz, nx * gy - ny * gx
    area, volume = area + n / 2, volume + (ax * nx + ay * ny + az * nz) / 6
    if n > 0 then bent = bent + (kx * kx + ky * ky + kz * kz) / (2 * n * g * g) end
  end
  return area, volume, math.sqrt(bent / area)
end

local function topology(m)
  local edges, count, broken = {}, 0, 0
  local vertices = #m.vertices // 3
  for t = 1, #m.faces, 3 do
    for k = 0, 2 do
      local a, b = m.faces[t + k], m.faces[t + (k + 1) % 3]
      local key, step = math.min(a, b) * (vertices + 1) + math.max(a, b), a < b and 1 or 1000
      if not edges[key] then count = count + 1 end
      edges[key] = (edges[key] or 0) + step
    end
  end
  for _, uses in pairs(edges) do
    if uses ~= 1001 then broken = broken + 1 end
  end
  return vertices - count + #m.faces // 3, broken
end

local function volume_of(scene, solid)
  local s, sum = scene:run { to = 0 }:state(), 0
  for _, t in ipairs(solid:tetrahedra()) do
    local a, b, c, d = s:position(t[1]), s:position(t[2]), s:position(t[3]), s:position(t[4])
    local u, v, w = {}, {}, {}
    for k = 1, 3 do u[k], v[k], w[k] = b[k] - a[k], c[k] - a[k], d[k] - a[k] end
    sum = sum + (u[1] * (v[2] * w[3] - v[3] * w[2]) + u[2] * (v[3] * w[1] - v[1] * w[3])
      + u[3] * (v[1] * w[2] - v[2] * w[1])) / 6
  end
  return sum
end

local function quantities(p)
  local exact = "the formula of Euler and Poincare, V - E + F = 2 - 2 g"
  local list = {}
  for _, method in ipairs { "tetrahedra", "cubes" } do
    local by = ", marching " .. method
    list[#list + 1] = { name = "area" .. by, unit = "m^2", reference = p.area, source = p.source }
    list[#list + 1] = { name = "volume" .. by, unit = "m^3", reference = p.volume, source = p.source }
    list[#list + 1] = { name = "sine between facets and surface" .. by, reference = 0, scale = 1, order = { space = 1 },
      source = "facets are tangent in the limit", tolerance = 6e-3, why = "what errors of order 1, some 0.03, leave" }
    list[#list + 1] = { name = "Euler's number" .. by, reference = p.euler, scale = 1, source = exact }
    list[#list + 1] = { name = "edges not in two triangles" .. by, reference = 0, scale = 1, source = "it is closed" }
  end
  list[#list + 1] = { name = "volume of the tetrahedra", unit = "m^3", reference = p.volume, source = p.source }
  return list
end

-- A problem: title, shape (keys of scene:implicit), gradient(x, y, z), half (the box is a cube of twice that), area,
-- volume, euler, source, space (16, 32, 64), quick (12, 16, 24); at.n is the number of cells along the box, which is off
-- the middle.
function surfaces.problem(p)
  local function asked(at, more)
    local request = { size = 2 * p.half / at.n * (1 + 1e-9), box = { {}, {} } }
    for c = 1, 3 do
      request.box[1][c], request.box[2][c] = (-1 + 0.01 * c) * p.half, (1 + 0.01 * c) * p.half
    end
    for _, list in ipairs { p.shape, more } do
      for key, value in pairs(list) do request[key] = value end
    end
    return request
  end
  return validation.problem {
    title = p.title,
    quantities = quantities(p),
    space = p.space or { 16, 32, 64 },
    space_label = "1/n, a part of the box",
    order = { space = 2, within = 0.3 },
    tolerance = 1e-3,
    why = "errors of order 2, of 1e-3 at n = 64, leave a tenth of that in the extrapolated value, or less",
    noise = 1e-12,
    quick = { space = p.quick or { 12, 16, 24 }, tolerance = 0.1 },
    solve = function(at)
      local scene = hooke.scene { duration = 0 }
      local values = {}
      for _, method in ipairs { "tetrahedra", "cubes" } do
        local m = scene:implicit(asked(at, { method = method, as = "surface" }))
        for _, value in ipairs { measure(m, p.gradient) } do values[#values + 1] = value end
        for _, value in ipairs { topology(m) } do values[#values + 1] = value end
      end
      local solid = scene:implicit(asked({ n = at.quick and at.n or at.n / 2 }, { as = "solid" }))
      values[#values + 1] = volume_of(scene, solid)
      return values
    end,
  }
end

return surfaces
