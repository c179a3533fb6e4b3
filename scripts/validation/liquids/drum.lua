-- A round drum, full of a viscous liquid at rest, begins to turn: start-up of a circular Couette flow. The liquid's
-- speed between the axis and the wall at two times.
local numerics = require("numerics")
local tank = require("_tank")
local validation = require("validation")

local R, nu, turn, step = 0.4, 0.05, 1, 0.005 -- m, m^2/s, rad/s, s
local times = { 0.2, 0.6 } -- s: nu t/R^2 = 0.06, 0.19

-- Of the angular momentum by that of the liquid as it turns in the end. u/(turn R) = y - sum of 2 J1(l y)/(l |J0(l)|) ...
-- gives, by its moment with y^2, 1 - 8 sum of exp(-l^2 nu t/R^2)/l^2 over the zeros l of J1.
local function momentum(t)
  local sum = 0
  for i = 1, 12 do
    local l = numerics.bessel_zero(1, i)
    sum = sum + math.exp(-l * l * nu * t / (R * R)) / (l * l)
  end
  return 1 - 8 * sum
end

local quantities = {}
for i, t in ipairs(times) do
  quantities[i] = { name = ("angular momentum at %g s"):format(t), reference = momentum(t),
    source = "closed form, series of J1: Batchelor 1967, section 4.5" }
end

return validation.problem {
  title = "A drum that begins to turn",
  quantities = quantities,
  space = { 16, 24, 32 },
  noise = 0.02,
  tolerance = 0.03,
  why = "implicit steps of 0.005 s leave 1 % at the first time, and walls between faces are of order 1 to 2",
  quick = { space = { 12, 14, 16 }, tolerance = 0.1 },
  solve = function(at)
    local function inside(x, _, z) return (x - 0.5) ^ 2 + (z - 0.5) ^ 2 < R * R end
    local scene, count, masses = tank.scene { n = at.n, h = step, top = 1, duration = times[2], inside = inside,
      with = { viscosity = 1000 * nu },
      before = function(scene)
        scene:corrector("obstacle", { shape = "sphere", size = { 2 * R, 2 * R, 2 * R }, hollow = true,
          position = { 0.5, 0, 0.5 },
          rotation = function(t) return 0, -turn * t, 0 end })
      end }
    local list = {}
    for i, t in ipairs(times) do
      local state, spin, most = scene:run { to = t }:state(), 0, 0
      for id = 1, count do
        local p, v = state:position(id), state:velocity(id)
        local x, z = p[1] - 0.5, p[3] - 0.5
        spin, most = spin + masses[id] * (x * v[3] - z * v[1]), most + masses[id] * (x * x + z * z)
      end
      list[i] = spin / most / turn
    end
    return list
  end,
}
