-- Gallium melts in a cavity from a hot side (Gau and Viskanta 1986, Melting and solidification of a pure metal on a vertical
-- wall, J. Heat Transfer 108, 174): 88.9 mm x 63.5 mm, Ra = 6.06e5, Pr = 0.0216, Stefan number 0.04, plane. The heat that
-- convection brings in while it goes on steadily, against the correlation of plane computations,
--     Nu = 0.29 Ra^0.27 Pr^0.18   (Gobin and Benard 1990, as quoted by Lim and Bejan 1992, J. Heat Transfer 114, 784);
-- conduction alone would bring 2.5 in these minutes. Nothing becomes warmer than the wall. The part that has melted in 19
-- minutes is some 0.7, and was measured as 0.57, in a cavity 38 mm deep.
local filling, heat, numbers = require("filling"), require("heat"), require("material_numbers")
local validation = require("validation")

local width, height, gravity, expansion, viscosity = 0.0889, 0.0635, 9.81, 1.2e-4, 1.81e-3 -- m, m, m/s^2, 1/K, Pa s
local hot, cold = 311.15, 301.45                                                          -- K
local from, to = 600, 1000                                                                -- s

local law, density = numbers.gallium.conduction, 6093

local function nusselt()
  local diffusivity, nu = law.conductivity / (density * law.capacity), viscosity / density
  local rayleigh = gravity * expansion * (hot - law.solidus) * height ^ 3 / (nu * diffusivity)
  return 0.29 * rayleigh ^ 0.27 * (nu / diffusivity) ^ 0.18
end

local function cavity(n)
  local cell = width / n
  local low, high = { 0, 0, 0 }, { width, 0, math.floor(height / cell + 0.5) * cell }
  local start = heat.enthalpy("gallium", cold)
  local scene = hooke.scene { duration = to, integrator = "symplectic_euler", fps = 0.1 }
  scene:channel("enthalpy", { initial = start })
  local metal = filling.box { low = low, high = high, cell = cell, density = density }
  local ids = scene:particles { positions = metal.positions, mass = metal.mass }
  scene:force("grid_conduction", { low = low, high = high, cell = cell, density = density, material = "gallium",
    channel = "enthalpy", temperatures = { hot, cold, 0, 0, 0, 0 } })
  scene:force("melt", { channel = "enthalpy", material = "gallium", viscosity = viscosity, solid = 1e8 })
  scene:force("buoyancy", { of = "melt", ambient = law.solidus, beta = expansion, g = { 0, 0, -gravity } })
  filling.tank(scene, low, high)
  scene:corrector("liquid", { low = low, high = high, cell = cell, density = density, viscosity_of = "melt" })
  return scene, ids:ids(), metal.mass / (cell * (high[3] - low[3]))
end

return validation.problem {
  title = "Gallium that melts in a cavity",
  quantities = {
    { name = "Nusselt number", unit = "", reference = nusselt, source = "Gobin and Benard 1990", noise = 0.3 },
    { name = "hottest particle above the wall", unit = "K", reference = 0, scale = 1, source = "heat flows to what is colder",
      tolerance = 0.05, why = "heat that no particle of a cell has room for goes to all of them", noise = 0.05 },
  },
  space = { 10, 14, 20 },
  tolerance = 0.2,
  why = "the correlation's own scatter, 10 %, and rolls that come and go",
  forces = { grid_conduction = { "low", "high", "cell", "density", "temperatures", "channel", "capacity", "conductivity",
      "solidus", "latent" }, melt = { "channel", "viscosity", "solid", "solidus", "latent", "capacity" },
    buoyancy = { "of", "ambient", "beta", "g" } },
  quick = false,
  solve = function(at)
    local scene, ids, mass = cavity(at.n)
    local heats, hottest = {}, 0
    scene:measure("heat", function(s) -- J for each m of height and of depth
      local sum = 0
      for _, id in ipairs(ids) do
        sum = sum + mass * s:channel("enthalpy", id)
        hottest = math.max(hottest, s:field("temperature", id) - hot)
      end
      heats[#heats + 1] = { s.t, sum }
      return sum
    end)
    scene:run()
    local first, last
    for _, h in ipairs(heats) do
      if math.abs(h[1] - from) < 1 then first = h end
      last = h
    end
    local flux = height * (last[2] - first[2]) / (last[1] - first[1]) -- W for each m of depth
    return { flux / (law.conductivity * (hot - law.solidus)), hottest }
  end,
}
