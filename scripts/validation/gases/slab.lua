-- Heat conducted through air at rest between a warm floor and a cold ceiling, of which the middle was the temperature.
local validation = require("validation")

local warm, cold, start, kappa, T = 310, 290, 300, 0.01, 5

-- Around the straight line the half that is odd about the middle decays: sum over even modes k = 2, 4, ...
local function temperature(z)
  local sum = warm + (cold - warm) * z
  for k = 2, 60, 2 do
    local b = 2 * (cold - warm) / (k * math.pi) -- of start - line, an odd saw tooth
    sum = sum + b * math.sin(k * math.pi * z) * math.exp(-kappa * (k * math.pi) ^ 2 * T)
  end
  return sum
end

return validation.problem {
  title = "Conduction in a slab",
  quantities = {
    { name = "temperature at a quarter", unit = "K", reference = function() return temperature(0.25) end, scale = 10,
      source = "closed form, a Fourier series" },
  },
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 1e-4,
  why = "order 2 in cells, of which explicit steps are a fixed part of h^2/kappa",
  quick = { space = { 8, 16, 32 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 10, dt = 0.1, integrator = "symplectic_euler" }
    local p = scene:particle { position = { 2 / at.n, 0, 0.25 }, mass = 1 }
    scene:pin({ p })
    scene:corrector("gas", { low = { 0, 0, 0 }, high = { 4 / at.n, 0, 1 }, cell = 1 / at.n, diffusivity = kappa,
      floor = warm, ceiling = cold, ambient = start, g = { 0, 0, 0 } })
    return scene:run():state():field("temperature", p)
  end,
}
