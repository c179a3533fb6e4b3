-- The vortices of taylor_green.lua, of 12 x 12 particles, by leapfrog at three steps against the same particles by dop853: the
-- order in time. Forces that depend on velocities are seen at the end of a step, so that it is that of leapfrog with them, too.
local sph, validation = require("_sph"), require("validation")

local nu, U, length, n, finish = 0.02, 0.2, 1, 12, 0.2 -- m^2/s, m/s, m, s

local function amplitude(options)
  options.duration, options.fps = finish, 1 / finish
  return sph.vortices(hooke.scene(options), n, length, U, nu, 2)(finish)
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
