-- x^4 + y^4 + z^4 = 1, nearly a cube: flat in the middle of its sides, where f hardly changes. The part of the first
-- octant over the places (y, z) has the area of |grad f| / f_x; its three thirds over the faces are alike.
local numerics = require("numerics")
local surfaces = require("_surfaces")

-- 24 times the part of an octant in which x is the largest, over p = y/x and q = z/x: the place is (1, p, q) / s with
-- s = (1 + p^4 + q^4)^(1/4), and the area of a surface that is a ray's function is r^3 |grad f| / (place . grad f) times
-- that of the ray's square at x = 1.
local function area()
  local function strip(p)
    return numerics.integrate(function(q)
      local s = (1 + p ^ 4 + q ^ 4) ^ 0.25
      return s ^ -3 * math.sqrt(1 + p ^ 6 + q ^ 6) / s ^ 3 / ((1 + p ^ 4 + q ^ 4) / s ^ 4)
    end, 0, 1)
  end
  return 24 * numerics.integrate(strip, 0, 1)
end

local function gamma_ratio() -- Gamma(5/4)^3 / Gamma(7/4), by Gamma's values in Abramowitz and Stegun, table 6.1
  return 0.9064024770554773 ^ 3 / 0.9190625268488483
end

return surfaces.problem {
  title = "x^4 + y^4 + z^4 = 1",
  shape = { f = function(x, y, z) return 1 - x ^ 4 - y ^ 4 - z ^ 4 end },
  gradient = function(x, y, z) return x ^ 3, y ^ 3, z ^ 3 end,
  half = 1.3,
  area = area,
  volume = 8 * gamma_ratio(),
  euler = 2,
  source = "Dirichlet's integral 8 Gamma(5/4)^3/Gamma(7/4); area by quadrature over a face of the cube",
}
