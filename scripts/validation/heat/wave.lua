-- A wave of temperature between particles of a liquid decays at the rate k^2 kappa, by the force particle_conduction.
local validation = require("validation")

local length, kappa, density = 1, 0.01, 1000 -- m; m^2/s; kg/m^3
local k = 2 * math.pi / length

return validation.problem {
  title = "Decay of a wave of temperature between particles",
  quantities = { { name = "rate", unit = "1/s", reference = kappa * k * k, source = "closed form, kappa k^2" } },
  space = { 8, 16, 32, 64 },
  order = { space = 2 },
  tolerance = 5e-4,
  why = "order 2, 6e-3 with 32 particles",
  quick = { space = { 8, 16, 32 }, tolerance = 1e-2 },
  solve = function(at)
    local dx, T = length / at.n, 0.5 / (kappa * k * k)
    local scene = hooke.scene { duration = T, fps = 1 / T, integrator = "rk4" }
    scene:channel("enthalpy", { initial = 0 })
    local first
    for i = 1, at.n do
      for j = 1, 8 do
        local x = (i - 0.5) * dx
        local id = scene:particle { position = { x, (j - 0.5) * dx, 0 }, mass = density * dx ^ 3, enthalpy = math.sin(k * x) }
        first = first or id
        scene:pin({ id }, { normal = { 0, 0, 1 } })
      end
    end
    scene:periodic { high = { length, 8 * dx, length }, axes = "xy" }
    scene:force("particle_conduction", { spacing = dx, dimensions = 2, density = density, capacity = 1, channel = "enthalpy",
      conductivity = kappa * density })
    local start = scene:run { to = 0 }:state():channel("enthalpy", first)
    return math.log(start / scene:run():state():channel("enthalpy", first)) / T
  end,
}
