-- One vortex of Taylor and Green's in a closed box whose walls slip, by pressures (`incompressible`), which find that the liquid
-- fills its room and draw it in: how fast it dies down while it hardly moves, and what is left of it after 1.6 turns at
-- Re = U length/nu = 200, where particles that nothing keeps apart pair along the ways that the flow stretches.
local sph, validation = require("_sph"), require("validation")

local U, length, k = 0.1, 1, math.pi -- m/s, m, 1/m
local slow, begin, finish = 0.05, 0.05, 0.25 -- m^2/s; s
local nu, long = U * length / 200, 4 -- m^2/s; s

local function mode(x, z) return U * math.sin(k * x) * math.cos(k * z), -U * math.cos(k * x) * math.sin(k * z) end

-- Returns a function: the amplitude at a time, by that of the start.
local function vortex(n, viscosity, duration)
  local dx = length / n
  local longest = math.min(0.2 * dx / U, 0.15 * dx ^ 2 / viscosity)
  local scene = hooke.scene { duration = duration, fps = 20 / duration, dt = duration / (20 * math.ceil(duration / longest / 20)),
    integrator = "symplectic_euler" }
  local ids = sph.fill(scene, dx, { 0, 0 }, { length, length }, { velocity = mode })
  sph.fill(scene, dx, { -3 * dx, -3 * dx }, { length + 3 * dx, length + 3 * dx }, { walls = true,
    inside = function(x, z) return x < 0 or z < 0 or x > length or z > length end })
  sph.forces(scene, dx, { mu = sph.density * viscosity, slip = true })
  return function(t)
    local state, sum, norm = scene:run { to = t }:state(), 0, 0
    for _, id in ipairs(ids) do
      local x, v = state:position(id), state:velocity(id)
      local u, w = mode(x[1], x[3])
      sum, norm = sum + u * v[1] + w * v[3], norm + u * u + w * w
    end
    return sum / norm
  end
end

return validation.problem {
  title = "A vortex between walls by particles",
  quantities = {
    { name = "rate", unit = "1/s", reference = 2 * slow * k ^ 2, source = "Taylor and Green 1937, 2 nu k^2", noise = 2e-2 },
    { name = "left", reference = math.exp(-2 * nu * k ^ 2 * long), source = "the same, exp(-2 nu k^2 t)", noise = 1e-2 },
  },
  space = { 16, 24, 32 },
  tolerance = 0.05,
  why = "particles leave their lattice, for which the kernels are calibrated, and are moved apart",
  quick = { space = { 12, 16, 24 }, tolerance = 0.1 },
  solve = function(at)
    local decays, lasts = vortex(at.n, slow, finish), vortex(at.n, nu, long)
    local first = decays(begin)
    return { rate = math.log(first / decays(finish)) / (finish - begin), left = lasts(long) }
  end,
}
