-- Taylor and Green's vortices in a periodic box, u = U sin(k x) cos(k z), w = -U cos(k x) sin(k z), die down as exp(-2 nu k^2 t):
-- how fast the sum of the velocities on this mode falls, while the particles leave their lattice, by compression (`sph`) and by
-- pressures (`incompressible`), for which the box, which repeats, is full.
local sph, validation = require("_sph"), require("validation")

local nu, U, length = 0.02, 0.2, 1 -- m^2/s, m/s, m
local k = 2 * math.pi / length
local begin, finish = 0.05, 0.25   -- s

return validation.problem {
  title = "Decay of vortices by particles",
  quantities = {
    { name = "rate", unit = "1/s", reference = 2 * nu * k ^ 2, source = "Taylor and Green 1937, 2 nu k^2" },
    { name = "rate_incompressible", unit = "1/s", reference = 2 * nu * k ^ 2, source = "the same" },
  },
  space = { 12, 16, 24 },
  tolerance = 0.05,
  why = "particles leave their lattice, for which the kernels are calibrated",
  quick = { space = { 8, 12, 16 }, tolerance = 0.1 },
  solve = function(at)
    local function rate(integrator, c)
      local scene = hooke.scene { duration = finish, fps = 1 / begin, dt = 0.1 * length / at.n, integrator = integrator }
      local amplitude = sph.vortices(scene, at.n, length, U, nu, c)
      return math.log(amplitude(begin) / amplitude(finish)) / (finish - begin)
    end
    return { rate = rate("leapfrog", 2), rate_incompressible = rate("symplectic_euler") }
  end,
}
