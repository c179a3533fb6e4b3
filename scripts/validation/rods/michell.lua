-- A straight rod is bent into a ring and its joined ends are turned against each other: at which angle the flat ring
-- becomes unstable. Forces on small displacements show it: w = cos 2 phi out of the plane and u = sin 2 phi outwards,
-- with cos(2 phi)/2 along, which keeps lengths. Their stiffness is a 2 x 2 matrix, linear in the angle, and singular at
-- the critical one.
local validation = require("validation")

local tiny = 1e-4

-- Mean forces on both displacements of the ring with n edges, of ratio GJ/EI, turned by `turn`, displaced by w and u.
local function forces(n, ratio, turn, w, u)
  local scene = hooke.scene { duration = 1, fps = 1, dt = 1, integrator = "leapfrog" }
  local positions, edges = {}, {}
  for i = 1, n do
    local phi = 2 * math.pi * i / n
    local r, along = 1 + u * math.sin(2 * phi), u * math.cos(2 * phi) / 2
    positions[i] = { r * math.cos(phi) - along * math.sin(phi), r * math.sin(phi) + along * math.cos(phi),
      w * math.cos(2 * phi) }
    edges[i] = { i, i % n + 1 }
  end
  scene:particles { positions = positions, mass = n }
  scene:force("rods", { edges = edges, EI = 1, GJ = ratio, rest = "straight", turn = turn })
  local s, Fw, Fu = scene:run { to = 0 }:state(), 0, 0
  for i = 1, n do
    local F, phi = s:force("rods", i), 2 * math.pi * i / n
    local c, d = math.cos(phi), math.sin(phi)
    Fw = Fw + F[3] * math.cos(2 * phi)
    Fu = Fu + (F[1] * c + F[2] * d) * math.sin(2 * phi) + (F[2] * c - F[1] * d) * math.cos(2 * phi) / 2
  end
  return Fw, Fu
end

-- { ww, wu, uw, uu } by central differences.
local function stiffness(n, ratio, turn)
  local K = {}
  for k, d in ipairs { { tiny, 0 }, { 0, tiny } } do
    local a, b = forces(n, ratio, turn, d[1], d[2])
    local c, e = forces(n, ratio, turn, -d[1], -d[2])
    K[k], K[k + 2] = (c - a) / (2 * tiny), (e - b) / (2 * tiny)
  end
  return { K[1], K[2], K[3], K[4] }
end

-- det (A + turn B) = 0
local function critical(n, ratio)
  local A, C, B = stiffness(n, ratio, 0), stiffness(n, ratio, 1), {}
  for k = 1, 4 do B[k] = C[k] - A[k] end
  local a = B[1] * B[4] - B[2] * B[3]
  local b = A[1] * B[4] + A[4] * B[1] - A[2] * B[3] - A[3] * B[2]
  local c = A[1] * A[4] - A[2] * A[3]
  local roots = math.sqrt(b * b - 4 * a * c)
  return math.max((-b + roots) / (2 * a), (-b - roots) / (2 * a))
end

local quantities, ratios = {}, { 0.5, 0.75, 1, 1.25 }
for k, ratio in ipairs(ratios) do
  quantities[k] = { name = ("critical angle, GJ/EI = %g"):format(ratio), unit = "rad",
    reference = 2 * math.pi * math.sqrt(3) / ratio, source = "Michell 1889, 2 pi sqrt(3) EI/GJ" }
end

return validation.problem {
  title = "Michell's ring: a twisted ring leaves its plane",
  quantities = quantities,
  space = { 50, 100, 200 },
  order = { space = 2, space_next = 4 },
  tolerance = 5e-8,
  noise = 1e-8,
  why = "what errors of orders 2 and 4, which falls by 16 a level, leave; differences over 1e-4 of forces of size 1",
  forces = { rods = { "edges", "EI", "GJ", "rest", "turn" } },
  quick = { space = { 20, 40, 80 }, tolerance = 1e-3 },
  solve = function(at)
    local found = {}
    for k, ratio in ipairs(ratios) do found[k] = critical(at.n, ratio) end
    return found
  end,
}
