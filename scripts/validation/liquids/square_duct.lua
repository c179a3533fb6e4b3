-- Steady flow through a square duct: slugs of viscous liquid are pulled along a duct 0.25 m wide that they fill, 3 and 6 widths long.
-- Their ends are free. What those change of the velocity falls by exp(-4.2) in a width (Papkovich and Fadle's functions for a plane
-- channel), and what is measured is the half width in the middle, 1.25 and 2.75 from them; but each end also takes a pressure in
-- proportion to the velocity, which is as if the pull were larger by c u/length (12 % of it, one width long). So 1/u is a linear function
-- of 1/length, as inertia is nothing (Re = 0.05), and the two lengths give it for a duct without ends.
local filling = require("filling")
local validation = require("validation")

local d, nu, pull, short = 0.25, 0.05, 0.2, 3 -- m, m^2/s, m/s^2, widths
local T, step = 0.75, 1 / 64 -- s: nu T/d^2 = 0.6, when exp(-2 pi^2 0.6) = 7e-6 is left of the start, by these steps 2e-5

-- m/s, of the mean velocity: the double series of sines; 0.0351443 pull d^2/nu (White 2006, Viscous fluid flow, section 3-3.3).
local function mean()
  local sum = 0
  for m = 1, 199, 2 do
    for n = 1, 199, 2 do sum = sum + 1 / (m * m * n * n * (m * m + n * n)) end
  end
  return 64 / math.pi ^ 6 * pull * d ^ 2 / nu * sum
end

local function found(n, widths)
  local cell = d / n
  local half = math.ceil(widths / 2 * n) * cell
  local scene = hooke.scene { duration = T, fps = 1 / step, dt = step, integrator = "symplectic_euler" }
  local water = filling.box { low = { -half, 0, 0 }, high = { half, d, d }, cell = cell, scatter = 0 }
  scene:particles { positions = water.positions, mass = water.mass }
  scene:force("gravity", { g = { pull, 0, 0 } })
  scene:corrector("liquid", { low = { -half - d, 0, 0 }, high = { half + d, d, d }, cell = cell, viscosity = 1000 * nu })
  local state, sum, count = scene:run { to = T }:state(), 0, 0
  for id = 1, #water.positions do
    if math.abs(water.positions[id][1]) < d / 4 then sum, count = sum + state:velocity(id)[1], count + 1 end
  end
  return sum / count, 2 * half
end

return validation.problem {
  title = "Flow through a square duct",
  quantities = { { name = "mean velocity", unit = "m/s", reference = mean(),
    source = "closed form, double Fourier series; White 2006, eq. 3-48" } },
  space = { 6, 8, 12 },
  noise = 2e-3,
  tolerance = 5e-3,
  why = "the five-point formula's own solution, read between centres as particles do, is 0.65, 0.40 and 0.20 % too fast with 6, 8 and 12 "
    .. "cells; particles' places, which the liquid evens, move values by as much again",
  quick = { space = { 4, 5, 6 }, tolerance = 0.02 },
  solve = function(at)
    local u1, l1 = found(at.n, short)
    local u2, l2 = found(at.n, 2 * short)
    return (l2 - l1) / (l2 / u2 - l1 / u1)
  end,
}
