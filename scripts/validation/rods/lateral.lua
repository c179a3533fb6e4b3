-- A narrow cantilever under a dead load at its tip stays upright up to a critical load, then it turns over. Its moment is
-- given to the straight rod as what a rest curvature the other way makes of it, so there is nothing to bring to rest: the
-- high side is stiff, that curvature as small as 4e-6. Across it the stiffness is K0 + P^2 K2, as twist follows.
local validation = require("validation")
local stiffness = require("_stiffness")

local high = 1e6 -- EI of the high side over that of the narrow one

-- Of the edges, so that each joint, which takes half of both of its own, has the moment P (1 - x) there.
local function curvatures(n, P)
  local list, last = { 0 }, P / high
  for k = 0, n - 1 do
    list[k + 2] = k == 0 and -last or -2 * P / high * (1 - k / n) - list[k + 1]
  end
  return list
end

local function critical(n)
  local function rods(P)
    return { EI = high, EI2 = 1, GJ = 1, axis = { 0, 0, 1 }, curvature = curvatures(n, P) }
  end
  -- Moves so small that what is 1e6 times as stiff stays linear.
  local A, C = stiffness.across(n, false, rods(0), 1e-11), stiffness.across(n, false, rods(2), 1e-11)
  local function definite(P)
    return stiffness.definite(function(r, c) return A[c][r][1] + (P / 2) ^ 2 * (C[c][r][1] - A[c][r][1]) end, n, n)
  end
  return stiffness.limit(definite, 1, 10)
end

return validation.problem {
  title = "Lateral buckling of a narrow cantilever",
  quantities = {
    { name = "critical load at the tip, P L^2/sqrt(EI2 GJ)", reference = 4.01259934,
      source = "Prandtl 1899, Michell 1899; twice the first zero of J_-1/4, 2.00629967, recomputed" },
  },
  space = { 24, 48, 96 },
  order = { space = 2, space_next = 3 },
  tolerance = 1e-7,
  noise = 1e-7,
  why = "what errors of orders 2 and 3, which falls by 7.9 a level, leave; a high side 1e6 times as stiff changes less than 1e-7",
  forces = { rods = { "edges", "EI", "EI2", "GJ", "axis", "curvature" } },
  quick = { space = { 8, 16, 32 }, tolerance = 1e-3 },
  solve = function(at) return critical(at.n) end,
}
