-- A standing wave of small amplitude on water: w^2 = g k tanh(k depth) (Airy). It starts flat, with the velocities of the
-- potential flow, and first comes back to flat after half a period.
local sph, validation = require("_sph"), require("validation")

local length, depth, g, c, amplitude = 1, 0.5, 10, 30, 0.03 -- m, m, m/s^2, m/s, m
local k = 2 * math.pi / length
local function sinh(x) return (math.exp(x) - math.exp(-x)) / 2 end
local function cosh(x) return (math.exp(x) + math.exp(-x)) / 2 end
local w = math.sqrt(g * k * sinh(k * depth) / cosh(k * depth))

return validation.problem {
  title = "Period of a standing wave on water",
  quantities = {
    { name = "period", unit = "s", reference = 2 * math.pi / w, source = "Airy, w^2 = g k tanh(k depth)" },
  },
  space = { 32, 48, 64 },
  space_label = "1/n, particles on a wavelength",
  tolerance = 2e-2,
  why = "particles on their lattice resist shear as long as they move by less than a spacing, so that small waves are slow",
  quick = { space = { 20, 24, 28 }, tolerance = 0.2 },
  solve = function(at)
    local dx = length / at.n
    local h = 0.2 * dx * 3 / c
    local scene = hooke.scene { duration = 2, fps = validation.fps(20 * h), dt = h, integrator = "leapfrog" }
    local function flow(x, z)
      local by = amplitude * w / sinh(k * depth)
      return by * cosh(k * z) * math.sin(k * x), -by * sinh(k * z) * math.cos(k * x)
    end
    local water = sph.fill(scene, dx, { 0, 0 }, { length, depth }, { velocity = flow })
    sph.fill(scene, dx, { 0, -3 * dx }, { length, 0 }, { walls = true })
    scene:periodic { high = { length, 1, 1 }, axes = "x" }
    scene:force("gravity", { g = { 0, 0, -g } })
    sph.forces(scene, dx, { c = c })
    local x0, watch = {}, validation.crossings()
    validation.each(scene, 20 * h, math.ceil(1.5 * 2 * math.pi / w / (20 * h)), function(state, t)
      local moved, speed = 0, 0
      for j, id in ipairs(water) do
        local x = state:position(id)[1]
        x0[j] = x0[j] or x
        moved = moved + (x - x0[j]) * math.sin(k * x0[j])
        speed = speed + state:velocity(id)[1] * math.sin(k * x0[j])
      end
      watch(t, moved, speed)
      return #watch.times > 1
    end)
    return watch.times[2]
  end,
}
