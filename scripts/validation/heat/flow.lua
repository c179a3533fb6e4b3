-- Flow of a liquid by particles whose viscosity follows its temperature, at speeds so small that rows stay in their places:
-- between plates at rest by a force, with mu = exp(-b z); and between plates that move, heated by its own friction, with
-- mu = exp(-T), at the speed where the stress is largest: a larger stress has no state of rest (Gruntfest 1963).
local validation = require("validation")

local b, density, slow, T0, reach = 2, 1000, 3e-4, 300, 2.5 -- kg/m^3; m/s and, squared, K: of one unit of speed and of temperature

local turning = 1.1996786402577337 -- a tanh a = 1; the speed is then 2 sqrt(2) sinh a = 4.26775588

-- A lattice with the spacing dx, `rows` of which lie above z = 0, in a box that repeats along x; `wall(row)` is the speed of
-- rows that are plates, in units, or nil; `warmth(row)` the temperature above T0, in units. Returns lists of ids by rows.
local function lattice(scene, dx, from, rows, wall, warmth)
  local list, across = {}, 8
  for row = from, rows do
    local ids, speed = {}, wall(row)
    for i = 1, across do
      local x, z = (i - 0.5) * dx, row * dx
      ids[i] = scene:particle { position = { x, 0, z }, mass = density * dx ^ 3, group = speed and "plate" or "liquid",
        enthalpy = T0 + warmth(row) * slow ^ 2 }
      if speed then
        scene:pin({ ids[i] }, { path = function(t) return speed * slow * t, 0, 0 end })
      else
        scene:pin({ ids[i] }, { normal = { 0, 1, 0 } })
      end
    end
    list[row] = ids
  end
  return list
end

local function forces(scene, dx, span)
  local common = function(t)
    t.spacing, t.dimensions, t.density, t.reach, t.wall_volume = dx, 2, density, reach, dx ^ 3
    return t
  end
  scene:force("melt", { channel = "enthalpy", capacity = 1, viscosity = density, temperatures = { T0, T0 + span },
    factors = { 1, math.exp(-span / slow ^ 2) } })
  scene:force("viscosity", common { viscosity_of = "melt" })
  return common
end

local function open(dx, duration)
  local scene = hooke.scene { duration = duration, fps = 1 / duration, dt = 0.06 * dx * dx, integrator = "symplectic_euler" }
  scene:channel("enthalpy", { initial = T0 })
  return scene
end

-- The mean speed between plates at z = 0 and 1; beyond the second one all is the other way round, and the box repeats.
local function poiseuille(n)
  local dx, mid = 1 / n, 0
  local scene = open(dx, 2.4)
  local rows = lattice(scene, dx, 0, 2 * n - 1, function(row) return row % n == 0 and 0 or nil end,
    function(row) return b * (row <= n and row / n or 2 - row / n) end)
  scene:periodic { high = { 8 * dx, 1, 2 }, axes = "xz" }
  forces(scene, dx, 4 * slow ^ 2)
  scene:force("field", { f = function(_, _, _, z) return (z < 1 and 1 or -1) * slow * density * dx ^ 3, 0, 0 end, group = "liquid" })
  local state = scene:run():state()
  for row = 1, n - 1 do mid = mid + state:velocity(rows[row][1])[1] / slow / n end
  return mid
end

-- The temperature in the middle between plates that move past each other at the speed U, when it is steady.
local function couette(n, U)
  local dx = 1 / n
  local scene = open(dx, 1.5)
  local rows = lattice(scene, dx, -2, n + 2, function(row) return (row <= 0 or row >= n) and (row > 0 and U or 0) or nil end,
    function() return 0 end)
  scene:periodic { high = { 8 * dx, 1, 1 }, axes = "x" }
  local common = forces(scene, dx, 20 * slow ^ 2)
  scene:force("viscous_heating", { of = "viscosity", channel = "enthalpy", group = "liquid" })
  scene:force("particle_conduction", common { channel = "enthalpy", capacity = 1, conductivity = density })
  return (scene:run():state():channel("enthalpy", rows[n // 2][1]) - T0) / slow ^ 2
end

local function poiseuille_exact()
  local e = math.exp(b)
  local C = (e / b - (e - 1) / b ^ 2) / ((e - 1) / b)
  -- of (C - z) exp(b z) from 0 to z, and of that from 0 to 1
  return C * ((e - 1) / b - 1) / b - (e / b ^ 2 - 2 * (e - 1) / b ^ 3 + 1 / b ^ 2)
end

return validation.problem {
  title = "Flow with a viscosity that follows the temperature",
  quantities = {
    { name = "mean speed between plates, mu = exp(-2 z)", unit = "of rho g L^2/mu", reference = poiseuille_exact,
      source = "closed form, (mu u')' = -1" },
    { name = "warmest at the turning point, mu = exp(-T)", reference = 2 * math.log((math.exp(turning) + math.exp(-turning)) / 2),
      source = "Nahme's flow at its largest stress, 2 log cosh a with a tanh a = 1; Gruntfest 1963", tolerance = 2e-2,
      why = "plates of particles lie within half a row" },
  },
  space = { 8, 12, 16 },
  tolerance = 1e-2,
  why = "2e-3 with 16 rows, 5e-3 with 10",
  quick = { space = { 6, 8, 10 }, tolerance = 4e-2 },
  solve = function(at) return { poiseuille(at.n), couette(at.n, math.sqrt(2) * (math.exp(turning) - math.exp(-turning))) } end,
}
