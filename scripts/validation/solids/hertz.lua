-- A soft ball is pressed between two planes, each of which comes nearer to its centre by d: Hertz's law has the force
-- F = 4/3 E* sqrt(R) d^(3/2), E* = E/(1 - nu^2), where the contact's radius a is small beside R; that of a ball is larger
-- by some a/(2 R). The reference is the ball itself: surface displacements of the elastic ball under an axially
-- symmetric pressure, by Legendre's polynomials, and the pressure (1 - s^2)^(k - 1/2), s = r/a, k = 1, 2, 3, that leaves the
-- contact flat. The planes are stiff springs, whose depth falls as 1/n (some 0.1 % of F at n = 12), the ball is a wedge about its axis.
local validation = require("validation")
local wedge = require("_wedge")

local R, E, nu, density, angle = 0.1, 1e5, 0.3, 1000, 0.2
local contacts = { math.sqrt(1 / 2) / 9, math.sqrt(1 / 2) / 4 } -- a/R: at these ends a cell, where n is divisible by six
local kinds, terms, places, points = 3, 1600, 15, 200

-- Of the pull P_n on the ball of radius 1 and E = 1: along the radius and, times dP_n/dtheta, along the meridian (Lurie 1964,
-- Three-dimensional problems of the theory of elasticity, section 6.2; with no shear at the surface).
local function response(n)
  local A = -(1 + nu) / (2 * (n * n + n + 1 + nu * (2 * n + 1)))
  if n == 0 then return A * (4 * nu - 2), 0 end
  local B = (n * n + 2 * n - 1 + 2 * nu) / (n - 1)
  return A * ((n + 1) * (n - 2 + 4 * nu) - n * B), A * (n + 5 - 4 * nu - B)
end

-- Calls f(n, P_n, P_n+1) at the cosine c, for n even.
local function legendre(c, f)
  local now, after = 1, c
  for n = 0, terms do
    if n % 2 == 0 then f(n, now, after) end
    now, after = after, ((2 * n + 3) * c * after - (n + 1) * now) / (n + 2)
  end
end

-- The coefficients of P_n of the pressures on both poles.
local function pressures(a)
  local p = {}
  for k = 1, kinds do p[k] = {} end
  for q = 1, points do
    local s = (q - 0.5) / points * math.pi / 2
    local r = a * math.sin(s)
    local c = math.sqrt(1 - r * r)
    local area = r * a * math.cos(s) / c * math.pi / 2 / points
    legendre(c, function(n, P)
      for k = 1, kinds do p[k][n] = (p[k][n] or 0) + (2 * n + 1) * math.cos(s) ^ (2 * k - 1) * P * area end
    end)
  end
  return p
end

local function least_squares(rows, right)
  local n, A = #rows[1], {}
  for i = 1, n do
    A[i] = {}
    for j = 1, n + 1 do
      A[i][j] = 0
      for m, row in ipairs(rows) do A[i][j] = A[i][j] + row[i] * (row[j] or right[m]) end
    end
  end
  for i = 1, n do -- the matrix is definite
    for r = 1, n do
      local part = r ~= i and A[r][i] / A[i][i] or 0
      for j = i, n + 1 do A[r][j] = A[r][j] - part * A[i][j] end
    end
  end
  local x = {}
  for i = 1, n do x[i] = A[i][n + 1] / A[i][i] end
  return x
end

local function hertz(d) return 4 / 3 / (1 - nu ^ 2) * d ^ 1.5 end

-- d/R, and F over Hertz's law, for a contact of the radius a R.
local function series(a)
  local p, rows, right, force = pressures(a), {}, {}, 0
  for m = 1, places do
    local r = a * math.sin((m - 0.5) / places * math.pi / 2)
    local c, row = math.sqrt(1 - r * r), { 0, 0, 0, 1 }
    legendre(c, function(n, P, after)
      local along, across = response(n)
      local down = -along * P * c - across * (n + 1) * (c * P - after) -- sin(theta) dP/dtheta = -(n + 1) (c P_n - P_n+1)
      for k = 1, kinds do row[k] = row[k] + p[k][n] * down end
    end)
    rows[m], right[m] = row, 1 - c
  end
  local x = least_squares(rows, right)
  for k = 1, kinds do force = force + 2 * math.pi * x[k] * a * a / (2 * k + 1) end
  return x[kinds + 1], force / hertz(x[kinds + 1])
end

-- The force over Hertz's law at each of the depths d/R; planes come nearer within 0.1 s, and then the ball comes to rest.
local function pressed(n, depths)
  local scene = hooke.scene { duration = 0.4, fps = 5, dt = 0.01, solver = "supernodal",
    integrator = { "backward_euler", tolerance = 1e-4 } }
  local body, equator = wedge.add(scene, n, R, angle, 2, density)
  scene:force("neo_hookean", { tetrahedra = body:tetrahedra(), E = E, nu = nu })
  local function depth(t)
    local from, to = t < 0.2 and 0 or depths[1], t < 0.2 and depths[1] or depths[2]
    return from + (to - from) * math.min(1, (t < 0.2 and t or t - 0.2) / 0.1)
  end
  scene:force("penalty", { shape = "plane", k = 5 * E * R * angle, normal = { 0, 0, -1 },
    position = function(t) return 0, 0, R * (1 - depth(t)) end })
  local found = {}
  for k, d in ipairs(depths) do
    local s, force = scene:run { to = 0.2 * k }:state(), 0
    for _, id in ipairs(equator) do force = force - s:force("neo_hookean", id)[3] end
    found[k] = force / (hertz(d) * E * R ^ 2 * math.sin(angle) / (2 * math.pi)) -- sections of the wedge are triangles
  end
  return found
end

local known
local function reference(k)
  if not known then
    known = {}
    for i, a in ipairs(contacts) do known[i] = { series(a) } end
  end
  return known[k]
end

local quantities = {}
for k, a in ipairs(contacts) do
  quantities[k] = { name = ("F/Hertz's law, a/R = %.2g"):format(a), reference = function() return reference(k)[2] end,
    tolerance = 2 / (3 * math.pi) * a, why = "half of the contact's mean strain, 4/(3 pi) a/R: the reference is for small ones",
    source = "series of Legendre for an elastic ball; Hertz 1882, 4/3 E* sqrt(R) d^1.5, is 1" }
end

return validation.problem {
  title = "Hertz: a soft ball between two planes",
  quantities = quantities,
  space = { 6, 12, 18 },
  order = { space = 2 },
  noise = 1e-4,
  forces = { neo_hookean = { "tetrahedra", "E", "nu" } },
  quick = false,
  solve = function(at) return pressed(at.n, { reference(1)[1], reference(2)[1] }) end,
}
