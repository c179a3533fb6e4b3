-- A pendulum of n links that do not stretch, in its angles from the vertical: the motion of a chain of bars by a program
-- that has no constraints. With s_k the mass from the k-th joint on, L the length of a link, c_ij = cos(a_i - a_j),
--   sum_j s_max(i,j) L^2 c_ij a_j'' = -sum_j s_max(i,j) L^2 sin(a_i - a_j) a_j'^2 - s_i g L sin a_i
-- (Lagrange's equations), by Runge's and Kutta's method of order 4. In a wind u(t) with the drag d each particle k feels
-- d (u - v_k) besides, which adds sum_(k >= i) L (cos a_i F_x + sin a_i F_z).
local links = {}

-- Solves the symmetric, definite A x = b in place of b, by elimination.
local function solve(A, b)
  local n = #b
  for k = 1, n do
    local row = A[k]
    for i = k + 1, n do
      local f, other = A[i][k] / row[k], A[i]
      for j = k + 1, n do other[j] = other[j] - f * row[j] end
      b[i] = b[i] - f * b[k]
    end
  end
  for k = n, 1, -1 do
    local sum, row = b[k], A[k]
    for j = k + 1, n do sum = sum - row[j] * b[j] end
    b[k] = sum / row[k]
  end
end

-- Adds the forces of a wind (m/s) to the right-hand side.
local function blow(b, y, cos, sin, p, t)
  local n, ux, uz = #b, p.wind(t)
  local fx, fz, vx, vz = {}, {}, 0, 0
  for k = 1, n do
    vx, vz = vx + p.L * cos[k] * y[n + k], vz + p.L * sin[k] * y[n + k]
    fx[k], fz[k] = p.drag * (ux - vx), p.drag * (uz - vz)
  end
  local sum_x, sum_z = 0, 0
  for i = n, 1, -1 do
    sum_x, sum_z = sum_x + fx[i], sum_z + fz[i]
    b[i] = b[i] + (cos[i] * sum_x + sin[i] * sum_z) / p.L
  end
end

-- y: n angles, then their n rates -> the rates of y.
local function slope(y, p, t)
  local n, A, b, out = #p.below, {}, {}, {}
  local cos, sin = {}, {}
  for i = 1, n do cos[i], sin[i] = math.cos(y[i]), math.sin(y[i]) end
  for i = 1, n do
    local row, sum = {}, -p.below[i] * p.g / p.L * sin[i]
    for j = 1, n do
      local m = p.below[i > j and i or j]
      row[j] = m * (cos[i] * cos[j] + sin[i] * sin[j])
      sum = sum - m * (sin[i] * cos[j] - cos[i] * sin[j]) * y[n + j] ^ 2
    end
    A[i], b[i] = row, sum
  end
  if p.wind then blow(b, y, cos, sin, p, t) end
  solve(A, b)
  for i = 1, n do out[i], out[n + i] = y[n + i], b[i] end
  return out
end

local function moved(y, h, k)
  local out = {}
  for i = 1, #y do out[i] = y[i] + h * k[i] end
  return out
end

local function step(y, t, h, p)
  local a = slope(y, p, t)
  local b = slope(moved(y, h / 2, a), p, t + h / 2)
  local c = slope(moved(y, h / 2, b), p, t + h / 2)
  local d = slope(moved(y, h, c), p, t + h)
  local out = {}
  for i = 1, #y do out[i] = y[i] + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]) end
  return out
end

-- given: n links of a length (m), the mass of the particles at their ends (kg), g (m/s^2), the angle (rad) of all at the
-- start, at rest; wind (m/s), a function of t to u_x and u_z, and drag (N s/m), or neither. Returns a function of t: x and
-- z of the ends of the links below the pin, from steps of h (s) or shorter ones.
function links.pendulum(given)
  local p = { g = given.g, L = given.length, below = {}, wind = given.wind, drag = given.drag }
  local y, time, known = nil, nil, {}
  for i = given.n, 1, -1 do p.below[i] = given.mass + (p.below[i + 1] or 0) end
  local function start()
    y, time = {}, 0
    for i = 1, given.n do y[i], y[given.n + i] = given.angle, 0 end
  end
  return function(t)
    if known[t] then return known[t] end
    if not time or t < time then start() end
    local count = math.ceil((t - time) / given.h - 1e-9)
    local h = (t - time) / count
    for k = 1, count do y = step(y, time + (k - 1) * h, h, p) end
    time = t
    local x, z, places = 0, 0, {}
    for i = 1, given.n do
      x, z = x + p.L * math.sin(y[i]), z - p.L * math.cos(y[i])
      places[i] = { x, z }
    end
    known[t] = places
    return places
  end
end

return links
