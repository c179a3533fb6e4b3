-- A cloth that hangs from a hot bar gives heat to the air on both of its sides: the temperature at its lower edge at rest.
local validation = require("validation")

local hot, air, m = 400, 300, 1.5 -- K; 1/m: sqrt(2 convection/(conductivity x thickness)); these and the capacity are 1

return validation.problem {
  title = "A cloth cools from a hot bar",
  quantities = {
    { name = "temperature of the lower edge above the air", unit = "K", reference = (hot - air) * 2 / (math.exp(m) + math.exp(-m)),
      source = "closed form, (T1 - T0)/cosh(m L); Incropera and DeWitt 2002, table 3.4" },
  },
  space = { 8, 16, 32 },
  order = { space = 2 },
  tolerance = 2e-6,
  why = "order 2, 4e-7 with 32 cells",
  forces = { conduction = { "triangles", "thickness", "held", "channel", "capacity", "conductivity" } },
  quick = { space = { 4, 8, 12 }, tolerance = 5e-5 },
  solve = function(at)
    local n, T = at.n, 4 -- s, of which exp(-(m^2 + pi^2/4) T) is 5e-9
    local scene = hooke.scene { duration = T, fps = 1 / T, integrator = "rk4" }
    scene:channel("enthalpy", { initial = hot })
    local sheet = scene:grid { nx = 3, ny = n + 1, width = 2 / n, height = 1, mass = 2 / n }
    local areas, held, ids = {}, {}, {}
    for i = 1, 3 do
      for j = 1, n + 1 do
        local id = sheet:at(i, j)
        if j == n + 1 then
          held[#held + 1] = id
        else
          ids[#ids + 1] = id
          areas[#areas + 1] = 2 * (i == 2 and 1 or 0.5) * (j > 1 and 1 or 0.5) / (n * n)
        end
      end
    end
    scene:pin(sheet)
    scene:force("conduction", { triangles = sheet:triangles(), thickness = 1, capacity = 1, conductivity = 1,
      channel = "enthalpy", held = held })
    scene:force("heating", { particles = ids, area = areas, convection = m * m / 2, surroundings = air, capacity = 1,
      channel = "enthalpy" })
    return scene:run():state():channel("enthalpy", sheet:at(2, 1)) - air
  end,
}
