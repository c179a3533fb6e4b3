-- A straight rod between clamps is twisted: at which torque it gives way to the side. Across the rod the stiffness is
-- A + i M B for displacements y + i z: bending, and what the torque M makes of a turn of an edge; it is measured at two
-- torques, and the least M is sought at which it is singular.
local validation = require("validation")
local stiffness = require("_stiffness")
local numerics = require("numerics")

-- tan x = x, M L/EI = 2 x
local function first_root()
  return 2 * numerics.root(function(x) return math.sin(x) - x * math.cos(x) end, 4, 4.7)
end

local function critical(n)
  local function rods(turn) return { EI = 1, GJ = 1, rest = "straight", turn = turn } end
  local A, C = stiffness.across(n, true, rods(0)), stiffness.across(n, true, rods(1))
  local function definite(M) -- unknowns y1, z1, y2, z2, ...
    return stiffness.definite(function(r, c)
      local i, j = (r + 1) // 2, (c + 1) // 2
      if r % 2 == c % 2 then return A[j][i][1] end
      return M * C[j][i][2] * (c % 2 == 1 and 1 or -1)
    end, 2 * (n - 1), 5)
  end
  return stiffness.limit(definite, 1, 20)
end

return validation.problem {
  title = "A twisted straight rod gives way",
  quantities = {
    { name = "critical torque over EI/L, clamped ends", reference = first_root,
      source = "Greenhill 1883; tan x = x, M L/EI = 2 x" },
  },
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 1e-5,
  noise = 1e-8,
  why = "order 2 leaves errors of order 4, some (2 pi/64)^4/10; displacements of 1e-5 of an edge",
  forces = { rods = { "edges", "EI", "GJ", "rest", "turn" } },
  quick = { space = { 8, 16, 32 }, tolerance = 1e-3 },
  solve = function(at) return critical(at.n) end,
}
