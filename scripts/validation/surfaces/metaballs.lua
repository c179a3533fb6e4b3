-- Two metaballs that have grown together, a body of revolution about x: its radius follows from the sum of their
-- falloffs, in which s, the square of the distance from the axis, is the unknown.
local numerics = require("numerics")
local surfaces = require("_surfaces")

local apart, R = 0.4, 1 -- m: half the distance of the centres; twice the radius of a ball

local function falloff(q) return q < 1 and 1 - 22 / 9 * q + 17 / 9 * q ^ 2 - 4 / 9 * q ^ 3 or 0 end
local function slope(q) return q < 1 and -22 / 9 + 34 / 9 * q - 12 / 9 * q ^ 2 or 0 end

local function value(x, s)
  return falloff(((x - apart) ^ 2 + s) / R ^ 2) + falloff(((x + apart) ^ 2 + s) / R ^ 2) - 0.5
end

local function profile(x) -- s and ds/dx
  local s = numerics.root(function(t) return value(x, t) end, 0, 1)
  local a, b = slope(((x - apart) ^ 2 + s) / R ^ 2), slope(((x + apart) ^ 2 + s) / R ^ 2)
  return s, -2 * (a * (x - apart) + b * (x + apart)) / (a + b)
end

local function half_of(integrand)
  local last = numerics.root(function(x) return value(x, 0) end, apart, 2)
  return 2 * numerics.integrate(function(x) return integrand(profile(math.min(x, last * (1 - 1e-15)))) end, 0, last)
end

return surfaces.problem {
  title = "Two metaballs",
  shape = { blobs = { { -apart, 0, 0, radius = R / 2 }, { apart, 0, 0, radius = R / 2 } } },
  gradient = function(x, y, z)
    local s = y * y + z * z
    local a, b = slope(((x - apart) ^ 2 + s) / R ^ 2), slope(((x + apart) ^ 2 + s) / R ^ 2)
    return a * (x - apart) + b * (x + apart), (a + b) * y, (a + b) * z
  end,
  half = 1.25,
  area = function() return 2 * math.pi * half_of(function(s, ds) return math.sqrt(s + ds * ds / 4) end) end,
  volume = function() return math.pi * half_of(function(s) return s end) end,
  euler = 2,
  source = "quadrature of the body of revolution",
}
