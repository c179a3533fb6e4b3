-- A balloon: a sphere of rubber is inflated to some times its radius. The pressure is p = 2 mu/R (1/s - 1/s^7) at the
-- stretch s, mu the shear modulus times the thickness at rest: it is largest at s = 7^(1/6), and falls from there on. That
-- is Laplace's law, p = 2 T/r, with the tension T = mu (1 - s^-6). The gas keeps the volume, so that the falling part is
-- stable, too. The sphere is an icosahedron, each edge divided into n.
local validation = require("validation")

local R, Y = 0.1, 30
local mu = Y / 3 -- nu = 1/2
local stretches = { 1.2, 7 ^ (1 / 6), 2 }

local function pressure(s) return 2 * mu / R * (1 / s - 1 / s ^ 7) end

local function energy(s) return 4 * math.pi * R ^ 2 * mu / 2 * (2 * s ^ 2 + 1 / s ^ 4 - 3) end

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

-- Its edges divided into n, all corners on the sphere of radius R.
local function sphere(n)
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

local function volume_of(x, faces)
  local sum = 0
  for _, f in ipairs(faces) do
    local p, q, r = x[f[1]], x[f[2]], x[f[3]]
    sum = sum + p[1] * (q[2] * r[3] - q[3] * r[2]) + p[2] * (q[3] * r[1] - q[1] * r[3]) + p[3] * (q[1] * r[2] - q[2] * r[1])
  end
  return sum / 6
end

-- Pressure and energy of the skin of a balloon at rest, by the force of the gas: its work in growing is 3 p V = sum f.x.
local function balloon(n, s)
  local vertices, faces = sphere(n)
  local scene = hooke.scene { duration = 3, fps = 10, integrator = "leapfrog" }
  local skin = scene:mesh { vertices = vertices, faces = faces, density = 0.3 }
  scene:force("membrane", { triangles = skin:triangles(), model = "neo_hookean", stiffness = Y, nu = 0.5 })
  local stiff = 10 * mu / R
  local inflation = s ^ 3 / (1 - pressure(s) / stiff)
  scene:force("volume", { triangles = skin:triangles(), k = stiff, inflation = inflation, label = "gas" })
  scene:force("drag", { rate = 60 })
  local state, x, sum = validation.rest(scene, 0.1, 1e-8, 3):state(), {}, 0
  for id = 1, state.n do
    local f = state:force("gas", id)
    x[id] = state:position(id)
    sum = sum + f[1] * x[id][1] + f[2] * x[id][2] + f[3] * x[id][3]
  end
  local V, V_0 = volume_of(x, faces), volume_of(vertices, faces)
  local reached, p = (V / V_0) ^ (1 / 3), sum / (3 * V)
  local gas = p ^ 2 * inflation * V_0 / (2 * stiff)
  return p * pressure(s) / pressure(reached), (state:potential() - gas) * energy(s) / energy(reached), reached
end

local quantities = {}
for k, s in ipairs(stretches) do
  quantities[k] = { name = ("pressure at stretch %.4g"):format(s), unit = "Pa", reference = pressure(s),
    source = "Green and Adkins 1960, 2 mu/R (1/s - 1/s^7)" }
end
quantities[4] = { name = "energy at stretch 2", unit = "J", reference = energy(2),
  source = "closed form, 4 pi R^2 mu/2 (2 s^2 + s^-4 - 3)" }

return validation.problem {
  title = "An inflated balloon of rubber",
  quantities = quantities,
  space = { 4, 8, 16 },
  order = { space = 2 },
  tolerance = 1e-4,
  why = "errors of order 2 leave those of order 4",
  noise = 1e-7,
  forces = { membrane = { "triangles", "stiffness", "nu", "model" } },
  quick = { space = { 3, 5, 7 }, tolerance = 1e-2 },
  solve = function(at)
    local p1, p2 = balloon(at.n, stretches[1]), balloon(at.n, stretches[2])
    local p3, E = balloon(at.n, stretches[3])
    return { p1, p2, p3, E }
  end,
}
