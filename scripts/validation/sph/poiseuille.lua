-- Between two plates of pinned particles a liquid begins to flow under a pull along them: start-up of a plane Poiseuille
-- flow, in a box that repeats along it. Its mean speed at two times.
local sph, validation = require("_sph"), require("validation")

local nu, pull, d = 0.1, 0.08, 1 -- m^2/s, m/s^2, m between the plates
local times = { 0.5, 2.5 }       -- s: nu t/d^2 = 0.05, 0.25

local function mean(t)
  local sum = 0
  for n = 1, 39, 2 do sum = sum + math.exp(-n * n * math.pi ^ 2 * nu * t / (d * d)) / n ^ 4 end
  return pull * d * d / (12 * nu) * (1 - 96 / math.pi ^ 4 * sum)
end

local quantities = {}
for i, t in ipairs(times) do
  quantities[i] = { name = ("mean speed at %g s"):format(t), unit = "m/s", reference = mean(t),
    source = "closed form, Fourier's series of the start-up between plates" }
end

return validation.problem {
  title = "Start-up of the flow between plates",
  quantities = quantities,
  space = { 8, 12, 16 },
  noise = 2e-4,
  tolerance = 0.03,
  why = "of what the levels tend to: walls of particles hold the liquid with order 1 only, and it is 20 % too fast with 16 of them",
  quick = { space = { 8, 10, 12 }, tolerance = 0.1 },
  solve = function(at)
    local dx, h = d / at.n, 2.5e-3
    local width = 6 * dx
    local scene = hooke.scene { duration = times[2], fps = 40, dt = h, integrator = "leapfrog" }
    local flow = sph.fill(scene, dx, { 0, 0 }, { width, d })
    sph.fill(scene, dx, { 0, -3 * dx }, { width, 0 }, { walls = true })
    sph.fill(scene, dx, { 0, d }, { width, d + 3 * dx }, { walls = true })
    scene:periodic { high = { width, 4 * d, 4 * d }, axes = "x" }
    sph.forces(scene, dx, { c = 2, mu = sph.density * nu, cavitates = false })
    scene:force("gravity", { g = { pull, 0, 0 }, only = flow })
    local list = {}
    for i, t in ipairs(times) do
      local state, sum = scene:run { to = t }:state(), 0
      for _, id in ipairs(flow) do sum = sum + state:velocity(id)[1] end
      list[i] = sum / #flow
    end
    return list
  end,
}
