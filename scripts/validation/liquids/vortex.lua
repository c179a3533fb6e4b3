-- Taylor and Green's vortex in a box whose walls do not hold it: u = U sin(pi x) cos(pi z), w = -U cos(pi x) sin(pi z) decays as
-- exp(-2 pi^2 nu t).
local tank = require("_tank")
local validation = require("validation")

local pi, U, nu, step, begin = math.pi, 0.01, 0.05, 0.005, 0.05 -- m/s, m^2/s, s, s

local function mode(x, z) return { math.sin(pi * x) * math.cos(pi * z), 0, -math.cos(pi * x) * math.sin(pi * z) } end

local function amplitude(state, count)
  local sum, norm = 0, 0
  for id = 1, count do
    local p, v = state:position(id), state:velocity(id)
    local m = mode(p[1], p[3])
    sum, norm = sum + m[1] * v[1] + m[3] * v[3], norm + m[1] * m[1] + m[3] * m[3]
  end
  return sum / norm
end

return validation.problem {
  title = "Decay of a vortex",
  quantities = { { name = "rate", unit = "1/s", reference = 2 * pi * pi * nu, source = "Taylor and Green 1937" } },
  space = { 8, 16, 24 },
  noise = 0.01,
  tolerance = 0.01,
  why = "implicit steps leave 0.25 % of the rate, differences (pi/n)^2/12; the rest is that of particles at random",
  quick = { space = { 6, 8, 10 }, tolerance = 0.05 },
  solve = function(at)
    local scene, count = tank.scene { n = at.n, h = step, top = 1, duration = 0.5,
      velocity = function(x, z) local m = mode(x, z) return { U * m[1], 0, U * m[3] } end,
      with = { viscosity = 1000 * nu, walls = "free_slip" } }
    local before = amplitude(scene:run { to = begin }:state(), count)
    return math.log(before / amplitude(scene:run { to = 0.5 }:state(), count)) / (0.5 - begin)
  end,
}
