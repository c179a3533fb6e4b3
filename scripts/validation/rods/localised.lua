-- A long twisted rod whose ends approach each other buckles into a helix that is confined to its middle. With the angle
-- phi between tangent and axis, phi0 in the middle, and the torque M,
--     cos phi = 1 - (1 - cos phi0)/cosh^2(s/s*),     1/s* = M/(2 EI) sqrt((1 - cos phi0)/(1 + cos phi0)),
-- the ends are nearer by 4 EI/M sin phi0, and what pulls them M^2/(2 EI (1 + cos phi0)). The rod starts on that curve,
-- with its twist, and comes to rest where its edges have it; springs are shortened by what the pull stretches them.
local validation = require("validation")

local EI, GJ, L, turns, approach = 1.345, 0.789, 9.29, 27, 0.3 -- N m^2, N m^2, m, 1, m
local EA, density = 2e4, 1                                      -- N, kg/m

local M = GJ * 2 * math.pi * turns / L
local phi0 = math.asin(approach * M / (4 * EI))
local c0 = math.cos(phi0)
local width = 2 * EI / M * math.sqrt((1 + c0) / (1 - c0))
local pull = M * M / (2 * EI * (1 + c0))

-- Tangents at s from the middle; they turn about the axis by M/EI/(1 + cos phi) per metre.
local function cosh(x) return (math.exp(x) + math.exp(-x)) / 2 end
local function cos_phi(s) return 1 - (1 - c0) / cosh(s / width) ^ 2 end

local function curve(n)
  local positions, fine, x = {}, 64, { 0, 0, 0 }
  local psi, h = 0, L / (n * fine)
  for i = 0, n do
    positions[i + 1] = { x[1], x[2], x[3] }
    for k = 1, fine do
      local s = (i * fine + k - 0.5) * h - L / 2
      local c = cos_phi(s)
      local sine, turn = math.sqrt(math.max(0, 1 - c * c)), M / EI / (1 + c) * h
      psi = psi + turn / 2
      for a, part in ipairs { sine * math.cos(psi), sine * math.sin(psi), c } do x[a] = x[a] + h * part end
      psi = psi + turn / 2
    end
  end
  return positions
end

return validation.problem {
  title = "A twisted rod buckles into a helix in its middle",
  quantities = {
    { name = "greatest angle between tangent and axis", unit = "rad", reference = phi0,
      source = "Coyne 1990; van der Heijden and Thompson 2000; the rod of Bergou and others 2008" },
    { name = "cos of that angle half a width from the middle", reference = cos_phi(width / 2),
      source = "the same, 1 - (1 - cos phi0)/cosh^2(s/s*)" },
  },
  space = { 160, 320, 640 },
  order = { space = 2, within = 0.4 },
  tolerance = 2e-2,
  why = "edges of the coarsest level turn by 0.3 rad: its error is 10 %, and the order still 1.7",
  forces = { rods = { "edges", "EI", "GJ", "rest", "turn" } },
  quick = { space = { 24, 48, 96 }, tolerance = 0.3 },
  solve = function(at)
    local n, l, edges, free, rest = at.n, L / at.n, {}, {}, {}
    local positions = curve(n)
    table.insert(positions, 1, { positions[1][1], positions[1][2], positions[1][3] - l })
    positions[n + 3] = { positions[n + 2][1], positions[n + 2][2], positions[n + 2][3] + l }
    for i = 1, n + 2 do
      edges[i] = { i, i + 1 }
      if i > 1 and i < n + 2 then
        free[i - 1], rest[i - 1] = edges[i], l * (1 - pull * cos_phi((i - 1.5) * l - L / 2) / EA)
      end
    end
    local scene = hooke.scene { duration = 60, fps = 20, integrator = "leapfrog" }
    scene:particles { positions = positions, mass = density * l }
    scene:pin { 1, 2, n + 2, n + 3 }
    scene:force("springs", { edges = free, k = EA / l, rest = rest })
    scene:force("rods", { edges = edges, EI = EI, GJ = GJ, rest = "straight", turn = 2 * math.pi * turns })
    scene:force("drag", { rate = 4 })
    local s = validation.rest(scene, 0.5, at.quick and 1e-2 or 1e-5, 60):state()
    local function angle(i) -- of the edge from node i
      local a, b = s:position(i + 1), s:position(i + 2)
      local d = { b[1] - a[1], b[2] - a[2], b[3] - a[3] }
      return math.atan(math.sqrt(d[1] ^ 2 + d[2] ^ 2), d[3])
    end
    -- cos phi between nodes, by the cosines of the edges on both sides and one further
    local function cosine(x) -- x: edges from the first node
      local k = math.floor(x - 0.5)
      local u, sum = x - 0.5 - k, 0
      local weight = { -u * (u - 1) * (u - 2) / 6, (u + 1) * (u - 1) * (u - 2) / 2, -(u + 1) * u * (u - 2) / 2,
        (u + 1) * u * (u - 1) / 6 }
      for q = 1, 4 do sum = sum + weight[q] * math.cos(angle(k + q - 1)) end
      return sum
    end
    return { math.acos(cosine(n / 2)), (cosine(n / 2 + width / 2 / l) + cosine(n / 2 - width / 2 / l)) / 2 }
  end,
}
