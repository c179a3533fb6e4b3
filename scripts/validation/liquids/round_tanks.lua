-- The first mode in which liquid sloshes in round tanks, whose walls cut the grid's cells: an upright cylinder, where it is known in closed
-- form, and a drum that lies on its side, half full, whose walls meet the surface at every slope as it swings.
local filling = require("filling")
local numerics = require("numerics")
local validation = require("validation")

local g, R, a, step, look = 9.81, 0.4, 0.01, 0.005, 4 -- m/s^2, m, m: height of the wave; s; steps between looks
local k = numerics.root(function(x) return numerics.bessel_j(0, x) - numerics.bessel_j(1, x) / x end, 1.5, 2.2) / R -- J1' = 0
local upright = math.sqrt(g * k * (1 - 2 / (math.exp(2 * k * R) + 1)))
local drum = math.sqrt(1.35573 * g / R)

-- 1/s: of the swings of the mass along x. deep: m, half the tank's depth along y; 0: a plane.
local function found(n, deep, swings, wave, inside, size)
  local scene = hooke.scene { duration = 4, fps = validation.fps(step), dt = step, integrator = "symplectic_euler" }
  local water = filling.box { low = { -0.5, -deep, -R }, high = { 0.5, deep, 0.1 }, cell = 1 / n, level = wave, inside = inside }
  scene:particles { positions = water.positions, masses = water.masses }
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:corrector("obstacle", { shape = deep > 0 and "cylinder" or "sphere", size = size, hollow = true, restitution = 0 })
  scene:corrector("liquid", { low = { -0.5, -deep, -0.5 }, high = { 0.5, deep, 0.5 }, cell = 1 / n })
  local zero = validation.crossings()
  validation.each(scene, look * step, 4 / (look * step), function(state, t)
    local y, slope = 0, 0
    for id, mass in ipairs(water.masses) do
      y, slope = y + mass * state:position(id)[1], slope + mass * state:velocity(id)[1]
    end
    return zero(t, y, slope) > swings
  end)
  return math.pi * swings / (zero.times[swings + 1] - zero.times[1])
end

local function mode(x, y)
  local r = math.sqrt(x * x + y * y)
  return r > 0 and a * numerics.bessel_j(1, k * math.min(r, R)) / numerics.bessel_j(1, k * R) * x / r or 0
end

return validation.problem {
  title = "Sloshing in round tanks",
  quantities = {
    { name = "frequency, upright cylinder", unit = "1/s", reference = upright,
      source = "Lamb 1932, section 257: sqrt(g k tanh(k d)), J1'(k R) = 0" },
    { name = "frequency, half full drum", unit = "1/s", reference = drum,
      source = "McIver 1989, Journal of Fluid Mechanics 201, 243: w^2 R/g = 1.3557; finite volumes in polar coordinates give 1.35573" },
  },
  space = { 12, 16, 24 },
  space_label = "1/n, cells a metre",
  noise = 0.02,
  tolerance = 0.01,
  why = "3.1, 1.6 and 0.2 % with 10, 13 and 19 cells across the cylinder; 0.5, 0.04 and 0.8 % with twice as many across the drum",
  quick = false,
  solve = function(at)
    return {
      found(at.n, 0.5, 2, mode, function(x, y) return x * x + y * y < R * R end, { 2 * R, 2 * R, 2 * R }),
      found(2 * at.n, 0, 4, function(x) return a * x / R end, function(x, _, z) return x * x + z * z < R * R end, { 2 * R, 2 * R, 2 * R }),
    }
  end,
}
