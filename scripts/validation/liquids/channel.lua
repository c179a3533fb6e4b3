-- A channel between two plates, 0.25 m apart, that viscous liquid comes into through all of its left end with the same speed everywhere;
-- a drain takes it where the plates end. What has come in is what the speed says, and half a metre on the flow is Poiseuille's: what the
-- uniform inflow leaves falls by exp(-4.2) in a width (Papkovich and Fadle's functions), here by exp(-6.3), and so for the free end.
local filling = require("filling")
local validation = require("validation")

local d, nu, U, widths = 0.25, 0.05, 0.1, 3 -- m, m^2/s, m/s, the plates' length in their distance
local T, half = 1.25, 0.25 -- s: ten times d^2/(pi^2 nu), and U T = d/2, a whole number of particles; of d, of what is measured

return validation.problem {
  title = "Flow into a channel",
  quantities = {
    { name = "mass that is in, by U d T", reference = 1, tolerance = 1e-12, source = "continuity",
      why = "each place of the inflow has borne the same whole number of particles" },
    { name = "mean speed", unit = "m/s", reference = U, noise = 3e-3, source = "continuity" },
    { name = "mean square by square of the mean", reference = 1.2, order = { time = 1 },
      source = "closed form, plane Poiseuille flow: Batchelor 1967, section 4.2" },
  },
  space = { 8, 12, 16 },
  time = { 1 / 100, 1 / 200, 1 / 400 },
  noise = 1e-3,
  tolerance = 0.01,
  why = "particles read the grid's velocity linearly, 2/n^2 less than its mean; pressure acts after viscosity, so that in a step of h "
    .. "the liquid slips along the plates with 12 nu h/d^2 of its speed, 2.4 % in the shortest: both vanish with their orders, 2 and 1",
  quick = { space = { 4, 5, 6 }, time = { 1 / 25, 1 / 50, 1 / 100 }, tolerance = 0.1 },
  solve = function(at)
    local cell, long = d / at.n, widths * d
    local scene = hooke.scene { duration = T, fps = validation.fps(at.h), dt = at.h, integrator = "symplectic_euler" }
    local water = filling.box { low = { 0, 0, 0 }, high = { long, 0, d }, cell = cell, scatter = 0 }
    scene:particles { positions = water.positions, mass = water.mass }
    scene:source("inflow", { low = { 0, 0, 0 }, high = { 0, 0, d }, direction = { 1, 0, 0 }, speed = U, cell = cell })
    scene:source("drain", { low = { long, -1, 0 }, high = { 2 * long, 1, d } })
    scene:corrector("liquid", { low = { 0, 0, 0 }, high = { long + 4 * cell, 0, d }, cell = cell, viscosity = 1000 * nu })
    local run = scene:run { to = T }
    local state, sum, squares, count = run:state(), 0, 0, 0
    for _, id in ipairs(state:ids()) do
      local u = state:velocity(id)[1]
      if math.abs(state:position(id)[1] - long / 2) < half * d then sum, squares, count = sum + u, squares + u * u, count + 1 end
    end
    local came
    for _, plugin in ipairs(run:summary().plugins) do came = came or plugin.figures and plugin.figures.mass_in end
    return { came / (1000 * U * d * cell * T), sum / count, squares * count / (sum * sum) }
  end,
}
