-- Two square sheets pass through each other: the upper one hangs through the lower one by its middle or by a corner. They
-- are drawn apart, until no edge of one passes a triangle of the other any more, and their momentum stays.
local validation = require("validation")

local depth, height = 0.03, 0.02 -- m: of the part that has gone through; of the rest

-- A sheet of n x n particles about (x, y), which have ids from `first` on, at the heights z(x, y).
local function sheet(scene, name, n, side, x0, y0, first, z)
  local vertices, faces, of_ids = {}, {}, {}
  for j = 0, n - 1 do
    for i = 0, n - 1 do
      local x, y = side * (i / (n - 1) - 0.5) + x0, side * (j / (n - 1) - 0.5) + y0
      vertices[#vertices + 1] = { x, y, z(x, y) }
    end
  end
  for j = 0, n - 2 do
    for i = 1, n - 1 do
      local k = j * n + i
      faces[#faces + 1] = { k, k + 1, k + n }
      faces[#faces + 1] = { k + 1, k + n + 1, k + n }
    end
  end
  for k, f in ipairs(faces) do of_ids[k] = { f[1] + first - 1, f[2] + first - 1, f[3] + first - 1 } end
  local mesh = scene:mesh { vertices = vertices, faces = faces, mass = 1 }
  scene:force("springs", { edges = mesh:edges(), k = 20, damping = 0.2, label = name })
  return { faces = of_ids }
end

local function sheets(n, h, place)
  local scene = hooke.scene { duration = 0.2, fps = 10, dt = h, integrator = "leapfrog" }
  local lower = sheet(scene, "lower", n, 1, 0, 0, 1, function() return 0 end)
  local upper = sheet(scene, "upper", n, 0.8, 0.013, 0.017, n * n + 1, function(x, y)
    return place(x, y) < 0.2 and -depth or height
  end)
  scene:corrector("contact", { thickness = 2e-3 })
  scene:corrector("untangle", { thickness = 2e-3 })
  return scene, lower, upper
end

local function volume(a, b, c, d)
  local u, v, w = {}, {}, {}
  for k = 1, 3 do u[k], v[k], w[k] = b[k] - a[k], c[k] - a[k], d[k] - a[k] end
  return u[1] * (v[2] * w[3] - v[3] * w[2]) + u[2] * (v[3] * w[1] - v[1] * w[3]) + u[3] * (v[1] * w[2] - v[2] * w[1])
end

-- Whether the edge p q passes the triangle a b c.
local function passes(p, q, a, b, c)
  if volume(p, a, b, c) * volume(q, a, b, c) >= 0 then return false end
  local x, y, z = volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)
  return (x > 0) == (y > 0) and (y > 0) == (z > 0)
end

-- How often an edge of one sheet passes a triangle of the other.
local function crossings(s, n, one, other)
  local count, x = 0, {}
  for id = 1, 2 * n * n do x[id] = s:position(id) end
  for _, sides in ipairs { { one, other }, { other, one } } do
    for _, t in ipairs(sides[2].faces) do
      local a, b, c = x[t[1]], x[t[2]], x[t[3]]
      for _, f in ipairs(sides[1].faces) do
        for k = 1, 3 do
          if passes(x[f[k]], x[f[k % 3 + 1]], a, b, c) then count = count + 1 end
        end
      end
    end
  end
  return count
end

-- Crossings at the start (1: there are some) and at the end, and the momentum along z.
local function apart(n, h, place)
  local scene, lower, upper = sheets(n, h, place)
  local start = crossings(scene:run { to = 0 }:state(), n, lower, upper)
  local s, momentum = scene:run():state(), 0
  for id = 1, 2 * n * n do momentum = momentum + s:velocity(id)[3] / n ^ 2 end
  return start > 0 and 1 or 0, crossings(s, n, lower, upper), momentum
end

local function middle(x, y) return math.sqrt(x * x + y * y) end
local function corner(x, y) return math.sqrt((x - 0.4) ^ 2 + (y - 0.4) ^ 2) end

local quantities = {}
for _, where in ipairs { "the middle", "a corner" } do
  quantities[#quantities + 1] = { name = where .. " passes at the start (1: yes)", reference = 1, source = "as it is laid" }
  quantities[#quantities + 1] = { name = "crossings at the end, " .. where, reference = 0, scale = 1,
    source = "Baraff, Witkin and Kass 2003: nothing is left" }
  quantities[#quantities + 1] = { name = "momentum, " .. where, unit = "kg m/s", reference = 0, scale = 1, source = "conserved" }
end

return validation.problem {
  title = "Sheets that lie in each other are drawn apart",
  quantities = quantities,
  space = { 6, 8, 10 },
  order = {},
  tolerance = 1e-12,
  noise = 1e-12,
  why = "none is left; rounding",
  quick = { space = { 5, 6, 7 }, tolerance = 1e-12 },
  solve = function(at)
    local a, b, p = apart(at.n, 1e-3, middle)
    local c, d, q = apart(at.n, 1e-3, corner)
    return { a, b, p, c, d, q }
  end,
}
