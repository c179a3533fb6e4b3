-- numerics: what references of known answers are computed with, to about 14 digits: elliptic integrals, Bessel functions
-- and their zeros, quadrature, roots, ordinary differential equations. Plain Lua, so it shares no code with the engine.
local numerics = {}

-- The arithmetic-geometric mean.
function numerics.agm(a, b)
  for _ = 1, 60 do
    if math.abs(a - b) <= 1e-16 * math.abs(a) then break end
    a, b = (a + b) / 2, math.sqrt(a * b)
  end
  return a
end

-- Complete elliptic integral of the first kind, of the modulus k (not m = k^2). Where k is nearly 1 its complement
-- sqrt(1 - k^2) is better given, too: k = sin a has cos a.
function numerics.ellipk(k, complement)
  return math.pi / 2 / numerics.agm(1, complement or math.sqrt((1 - k) * (1 + k)))
end

-- Complete elliptic integral of the second kind: E = K (1 - sum 2^(n-1) c_n^2) (Abramowitz and Stegun 17.6).
function numerics.ellipe(k)
  local a, b, c, sum, power = 1, math.sqrt((1 - k) * (1 + k)), k, 0, 0.5
  for _ = 1, 60 do
    sum = sum + power * c * c
    if math.abs(c) < 1e-17 then break end
    a, b, c = (a + b) / 2, math.sqrt(a * b), (a - b) / 2
    power = 2 * power
  end
  return math.pi / 2 / a * (1 - sum)
end

-- Tanh-sinh quadrature (Takahasi and Mori 1974) of a function that is smooth inside; singularities at the ends do no harm
-- if they can be integrated. f(x, d) also gets the distance d to the nearer end, which x alone, near an end that is not
-- 0, has lost: 1/sqrt(1 - x) is then 1/sqrt(d) there, or eight digits of the integral are lost.
function numerics.integrate(f, a, b)
  local half = (b - a) / 2
  local function level(h, first, step)
    local sum = 0
    for k = first, math.ceil(6.5 / h), step do
      for _, t in ipairs(k == 0 and { 0 } or { k * h, -k * h }) do
        local s = math.pi / 2 * (math.exp(t) - math.exp(-t)) / 2
        local off = 2 / (1 + math.exp(2 * math.abs(s))) -- 1 - tanh|s|, without cancellation
        local near = half * off
        local x = s < 0 and a + near or b - near
        local c = (math.exp(s) + math.exp(-s)) / 2
        local weight = math.pi / 2 * (math.exp(t) + math.exp(-t)) / 2 / (c * c)
        local value = near > 0 and weight > 1e-300 and weight * f(x, near) or 0
        if value - value == 0 then sum = sum + value end -- infinite where x has been rounded to the end
      end
    end
    return sum
  end
  local h = 0.5
  local sum = level(h, 0, 1)
  local value = h * sum
  for _ = 1, 7 do
    h = h / 2
    sum = sum + level(h, 1, 2)
    local better = h * sum
    local change = math.abs(better - value)
    value = better
    if change <= 1e-15 * math.abs(value) then break end
  end
  return half * value
end

-- Elliptic integral of the first kind, F(phi, k), by quadrature.
function numerics.ellipf(phi, k)
  return numerics.integrate(function(x) return 1 / math.sqrt(1 - (k * math.sin(x)) ^ 2) end, 0, phi)
end

-- The root of f in [a, b], where its sign differs, by bisection with secants (Illinois).
function numerics.root(f, a, b)
  local fa, fb = f(a), f(b)
  if fa == 0 then return a end
  if fb == 0 then return b end
  if (fa > 0) == (fb > 0) then error(("root: the function has the same sign at %g and %g"):format(a, b), 2) end
  for k = 1, 200 do
    local x = k % 3 == 0 and (a + b) / 2 or (a * fb - b * fa) / (fb - fa)
    local fx = f(x)
    if fx == 0 or math.abs(b - a) <= 4e-16 * math.max(math.abs(a), math.abs(b)) then return x end
    if (fx > 0) == (fb > 0) then
      b, fb, fa = x, fx, fa / 2
    else
      a, fa, fb = x, fx, fb / 2
    end
  end
  return (a + b) / 2
end

-- Bessel function of the first kind of a whole order, from its integral (1/pi) int_0^pi cos(n t - x sin t) dt by the
-- trapezoidal rule, which converges faster than any power for a periodic function.
function numerics.bessel_j(n, x)
  local m = 40 + 2 * math.ceil(math.abs(x) + n)
  local sum = (1 + math.cos(n * math.pi)) / 2
  for k = 1, m - 1 do
    local t = math.pi * k / m
    sum = sum + math.cos(n * t - x * math.sin(t))
  end
  return sum / m
end

-- The k-th positive zero of J_n, between the bounds of McMahon's expansion for small orders (n <= 2).
function numerics.bessel_zero(n, k)
  local middle = (k + n / 2 - 0.25) * math.pi
  return numerics.root(function(x) return numerics.bessel_j(n, x) end, middle - 0.9, middle + 0.9)
end

-- Extrapolates y' = f(t, y), y a list, from t0 to t1 with Gragg's and Bulirsch's method in `steps` large steps (16): the
-- relative change by the last column is below 1e-14 for smooth problems, or the step is halved.
local function gragg(f, t, y, H, n)
  local h, m = H / n, #y
  local before, now, slope = y, {}, f(t, y)
  for i = 1, m do now[i] = y[i] + h * slope[i] end
  for k = 1, n - 1 do
    slope = f(t + k * h, now)
    local after = {}
    for i = 1, m do after[i] = before[i] + 2 * h * slope[i] end
    before, now = now, after
  end
  slope = f(t + H, now)
  local out = {}
  for i = 1, m do out[i] = (before[i] + now[i] + h * slope[i]) / 2 end
  return out
end

local function extrapolated(f, t, y, H)
  local rows = {}
  for k = 1, 10 do
    local row = { gragg(f, t, y, H, 2 * k) }
    for j = 1, k - 1 do
      local factor, next_one = 1 / ((k / (k - j)) ^ 2 - 1), {}
      for i = 1, #y do next_one[i] = row[j][i] + (row[j][i] - rows[k - 1][j][i]) * factor end
      row[j + 1] = next_one
    end
    rows[k] = row
    local off, size = 0, 1e-300
    for i = 1, k > 2 and #y or 0 do
      off = math.max(off, math.abs(row[k][i] - row[k - 1][i]))
      size = math.max(size, math.abs(row[k][i]))
    end
    if k > 2 and off <= 2e-15 * size then return row[k] end
  end
  return nil, rows[10][10]
end

-- The solution of y' = f(t, y) at t1; y0 and what f returns are lists.
function numerics.ode(f, t0, y0, t1)
  local t, y, H = t0, y0, (t1 - t0) / 16
  while math.abs(t1 - t) > 1e-14 * math.abs(t1 - t0) do
    if math.abs(H) > math.abs(t1 - t) then H = t1 - t end
    local next_one, rough = extrapolated(f, t, y, H)
    if not next_one and math.abs(H) < 1e-9 * math.abs(t1 - t0) then next_one = rough end
    if next_one then
      t, y, H = t + H, next_one, 1.2 * H
    else
      H = H / 2
    end
  end
  return y
end

return numerics
