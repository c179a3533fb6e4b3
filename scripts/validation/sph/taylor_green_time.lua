-- The vortices of taylor_green.lua, of 12 x 12 particles, by leapfrog at three steps against the same particles by dop853: the
-- order in time. Forces that depend on velocities are seen at the end of a step, so that it is that of leapfrog with them, too.
local sph, validation = require("_sph"), require("validation")

local nu, U, length, n, finish = 0.02, 0.2, 1, 12, 0.2 -- m^2/s, m/s, m, s
local k = 2 * math.pi / length

local function mode(x, z) return math.sin(k * x) * math.cos(k * z), -math.cos(k * x) * math.sin(k * z) end

local function amplitude(options)
  options.duration, options.fps = finish, 1 / finish
  local dx, scene = length / n, hooke.scene(options)
  local ids = sph.fill(scene, dx, { 0, 0 }, { length, length },
    { velocity = function(x, z) local u, w = mode(x, z) return U * u, U * w end })
  scene:periodic { high = { length, length, length }, axes = "xz" }
  sph.forces(scene, dx, { c = 2, mu = sph.density * nu, cavitates = false })
  local state, sum, norm = scene:run { to = finish }:state(), 0, 0
  for _, id in ipairs(ids) do
    local x, v = state:position(id), state:velocity(id)
    local u, w = mode(x[1], x[3])
    sum, norm = sum + u * v[1] + w * v[3], norm + u * u + w * w
  end
  return sum / norm
end

return validation.problem {
  title = "Order in time of vortices by particles",
  quantities = {
    { name = "amplitude", unit = "m/s", reference = function() return amplitude { integrator = "dop853", tol = 1e-9 } end,
      source = "the same particles by dop853 at 1e-9" },
  },
  time = { 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "what is left of order 3 and above after Richardson's extrapolation",
  quick = { time = { 0.02, 0.01, 0.005 }, tolerance = 1e-4 },
  solve = function(at) return amplitude { integrator = "leapfrog", dt = at.h } end,
}
