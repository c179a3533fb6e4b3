-- N stars drawn from Plummer's sphere, places and speeds by Halton's sequences: potential energy -3 pi/32, kinetic energy
-- 3 pi/64, and 2 T + W = 0 (G = M = a = 1), as far as N stars can tell. Sums over all pairs, and the octree's.
local validation = require("validation")

local function halton(k, base)
  local x, part = 0, 1 / base
  while k > 0 do k, x, part = k // base, x + part * (k % base), part / base end
  return x
end

-- The q = v/(escape speed) below which a part p of the stars is: integral of q^2 (1 - q^2)^(7/2) (Aarseth, Henon and
-- Wielen 1974), by bisection in a table.
local cumulative = { [0] = 0 }
local cells = 4096
for i = 1, cells do
  local q = (i - 0.5) / cells
  cumulative[i] = cumulative[i - 1] + q * q * (1 - q * q) ^ 3.5
end
local function speed(p)
  local low, high, wanted = 0, cells, p * cumulative[cells]
  while high - low > 1 do
    local middle = (low + high) // 2
    if cumulative[middle] < wanted then low = middle else high = middle end
  end
  return (low + (wanted - cumulative[low]) / (cumulative[high] - cumulative[low])) / cells
end

local function stars(N)
  local x, v = {}, {}
  for k = 1, N do
    local r = 1 / math.sqrt(((k - 0.5) / N) ^ (-2 / 3) - 1)
    local z, angle = 2 * halton(k, 2) - 1, 2 * math.pi * halton(k, 3)
    local s, w = math.sqrt(1 - z * z), speed(halton(k, 5)) * math.sqrt(2) * (1 + r * r) ^ -0.25
    x[k], v[k] = { r * s * math.cos(angle), r * s * math.sin(angle), r * z }, { 0, 0, w }
  end
  return x, v
end

local source = "Plummer 1911; Aarseth, Henon and Wielen, Astronomy and Astrophysics 37 (1974)"

return validation.problem {
  title = "Energies of Plummer's sphere of stars",
  quantities = {
    { name = "W N/(N - 1), all pairs", unit = "J", reference = -3 * math.pi / 32, source = source },
    { name = "W N/(N - 1), octree", unit = "J", reference = -3 * math.pi / 32, source = source },
    { name = "T", unit = "J", reference = 3 * math.pi / 64, source = source },
    { name = "-2 T/W", reference = 1, source = "virial theorem" },
  },
  space = { 1000, 2000, 4000 },
  space_label = "N",
  tolerance = 0.015,
  noise = 0.02,
  why = "of pairs that lie close together there are few: 1/sqrt(N)",
  forces = { nbody = { "G" } },
  quick = { space = { 200, 400, 800 }, tolerance = 0.03 },
  solve = function(at)
    local x, v = stars(at.n)
    local found = {}
    for i, method in ipairs { "direct", "tree" } do
      local scene = hooke.scene { duration = 1, fps = 1, dt = 1, integrator = "leapfrog" }
      scene:particles { positions = x, velocities = v, mass = 1 / at.n }
      scene:force("nbody", { G = 1, method = method })
      local s = scene:run { to = 0 }:state()
      found[i], found[3] = s:potential() * at.n / (at.n - 1), s:kinetic()
    end
    found[4] = -2 * found[3] / found[1]
    return found
  end,
}
