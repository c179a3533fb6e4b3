-- A straight rod that is curved and twisted at rest is clamped at one end and let go: it curls up to a helix of that curvature and torsion.
local validation = require("validation")

local curvature, torsion, length = 6, 3, 1.5
local square = curvature ^ 2 + torsion ^ 2

local function minus(a, b) return { a[1] - b[1], a[2] - b[2], a[3] - b[3] } end
local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end
local function cross(a, b)
  return { a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1] }
end

-- Radius and pitch of the helix through four points at equal angles on it: their second differences point to its axis
-- and are turned against each other by that angle.
local function helix_through(a, b, c, d)
  local p, q = minus(minus(a, b), minus(b, c)), minus(minus(b, c), minus(c, d))
  local axis = cross(p, q)
  local size = math.sqrt(dot(axis, axis))
  local angle = math.atan(size, dot(p, q))
  return math.sqrt(dot(p, p)) / (2 - 2 * math.cos(angle)), 2 * math.pi / angle * dot(minus(c, b), axis) / size
end

return validation.problem {
  title = "A rod relaxes to the helix of its rest curvature and torsion",
  quantities = {
    { name = "radius", unit = "m", reference = curvature / square, source = "closed form, k/(k^2 + t^2)" },
    { name = "pitch", unit = "m", reference = 2 * math.pi * torsion / square, source = "closed form, 2 pi t/(k^2 + t^2)" },
  },
  space = { 16, 32, 64 },
  order = { space = 2, space_next = 4 },
  tolerance = 2e-7,
  noise = 1e-7,
  why = "errors of order 6: edges turn by 0.16 rad at 64, 0.16^6/500 = 3e-8; at rest to 1e-8 m/s",
  forces = { rods = { "edges", "EI", "GJ", "curvature", "torsion" } },
  quick = { space = { 6, 12, 24 }, tolerance = 2e-3 },
  solve = function(at)
    local n, positions, edges = at.n, {}, {}
    for i = -1, n do
      positions[i + 2] = { length * i / n, 0, 0 }
      if i >= 0 then edges[i + 1] = { i + 1, i + 2 } end
    end
    local scene = hooke.scene { duration = 40, fps = 20, integrator = "leapfrog" }
    scene:particles { positions = positions, mass = 1 / n }
    scene:pin { 1, 2 } -- an edge in the wall: a free straight rod could curl in any direction
    scene:force("springs", { edges = edges, k = 500 * n })
    scene:force("rods", { edges = edges, EI = 1, GJ = 0.7, curvature = curvature, torsion = torsion })
    scene:force("drag", { rate = 3 })
    local s, middle = validation.rest(scene, 0.25, 1e-8, 40):state(), n // 2
    return { helix_through(s:position(middle - 1), s:position(middle), s:position(middle + 1), s:position(middle + 2)) }
  end,
}
