-- Start-up of plane Couette flow: a liquid at rest between plates 0.25 m apart, of which the upper one begins to move along
-- itself. The liquid is six gaps long and has free ends, without gravity, whose influence falls by exp(-pi) in a gap; what is measured
-- is the gap in the middle, 2.5 from them.
local filling = require("filling")
local validation = require("validation")

local d, nu, U, length = 0.25, 0.05, 0.02, 1.5 -- m, m^2/s, m/s, m
local times = { 0.0625, 0.25 } -- s: nu t/d^2 = 0.05, 0.2

-- Of the mean velocity by that of the plate: 1/2 - sum over odd n of 4/(n pi)^2 exp(-n^2 pi^2 nu t/d^2).
local function mean(t)
  local sum = 0.5
  for n = 1, 41, 2 do sum = sum - 4 / (n * math.pi) ^ 2 * math.exp(-(n * math.pi) ^ 2 * nu * t / d ^ 2) end
  return sum
end

local quantities = {}
for i, t in ipairs(times) do
  quantities[i] = { name = ("mean velocity at %g s"):format(t), reference = mean(t),
    source = "closed form, Fourier series: Batchelor 1967, section 4.3" }
end
quantities[1].order = { space = 2, time = 1 } -- at the second time differences are as small as the noise

return validation.problem {
  title = "Start-up of plane Couette flow",
  quantities = quantities,
  space = { 8, 16, 32 },
  time = { 1 / 160, 1 / 320, 1 / 640 },
  noise = 2e-3,
  tolerance = 0.01,
  why = "order 2 in space and 1 in time; the terms of higher order, and the noise of particles, leave 0.7 % at the first time",
  quick = { space = { 4, 6, 8 }, time = { 1 / 80, 1 / 160, 1 / 320 }, tolerance = 0.1 },
  solve = function(at)
    local cell, steps = d / at.n, math.floor(1 / at.h + 0.5)
    local scene = hooke.scene { duration = times[2], fps = steps, dt = 1 / steps, integrator = "symplectic_euler" }
    local water = filling.box { low = { -length / 2, 0, 0 }, high = { length / 2, 0, d }, cell = cell, scatter = 0 }
    scene:particles { positions = water.positions, mass = water.mass }
    scene:corrector("obstacle", { shape = "box", size = { 4 * length, 1, 4 * cell },
      position = function(t) return U * t, 0, d + 2 * cell end })
    scene:corrector("liquid", { low = { -0.75 * length, 0, 0 }, high = { 0.75 * length, 0, d + 2 * cell }, cell = cell,
      viscosity = 1000 * nu })
    local list = {}
    for i, t in ipairs(times) do
      local state, sum, count = scene:run { to = t }:state(), 0, 0
      for id = 1, #water.positions do
        if math.abs(water.positions[id][1]) < d / 2 then
          sum, count = sum + state:velocity(id)[1], count + 1
        end
      end
      list[i] = sum / count / U
    end
    return list
  end,
}
