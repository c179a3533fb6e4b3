-- A shear wave in a periodic box loses its speed at the rate nu k^2, by the force `viscosity` between particles on their
-- lattice: its kernel is calibrated there, so that what is left is its width, of order 2, and the lattice's axes.
local sph, validation = require("_sph"), require("validation")

local nu, length = 0.01, 1
local k = 2 * math.pi / length

return validation.problem {
  title = "Decay of a shear wave",
  quantities = {
    { name = "rate", unit = "1/s", reference = nu * k ^ 2, source = "closed form, nu k^2" },
  },
  space = { 8, 16, 32, 64 },
  order = { space = 2 },
  tolerance = 5e-4,
  why = "the sum of x^2 y^2 over the square lattice is 2e-4 more than an eighth of that of r^4, with a kernel of 2.5 spacings",
  quick = { space = { 8, 16, 32 }, tolerance = 1e-2 },
  solve = function(at)
    local dx, h = length / at.n, 1e-3
    local scene = hooke.scene { duration = 1, fps = 1 / h, dt = h, integrator = "rk4" }
    local ids = sph.fill(scene, dx, { 0, 0 }, { length, length },
      { velocity = function(_, z) return 1e-3 * math.sin(k * z), 0 end })
    scene:periodic { high = { length, length, length }, axes = "xz" }
    sph.forces(scene, dx, { c = 1, reach = 2.5, mu = sph.density * nu, cavitates = false })
    local function speed(state)
      local sum = 0
      for _, id in ipairs(ids) do
        sum = sum + state:velocity(id)[1] * math.sin(k * state:position(id)[3])
      end
      return sum
    end
    local run, t = scene:run { to = 0 }, 4 * h
    local first = speed(run:state())
    run = scene:run { to = t }
    return math.log(first / speed(run:state())) / t
  end,
}
