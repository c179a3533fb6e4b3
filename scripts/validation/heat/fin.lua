-- A fin, held hot at its foot, gives heat to the air along its sides: the temperature at its tip and what it gives, both at
-- rest.
local bar, validation = require("_bar"), require("validation")

local m = 2 -- 1/m: sqrt(convection x perimeter/(conductivity x section)); conductivity, section and capacity are 1
local T = 12 -- s, of which exp(-(m^2 + pi^2/4) T) is nothing
local hot, air = 400, 300

return validation.problem {
  title = "A fin",
  quantities = {
    { name = "temperature of the tip above the air", unit = "K", reference = (hot - air) / (math.exp(m) / 2 + math.exp(-m) / 2),
      source = "closed form, (T1 - T0)/cosh(m L); Incropera and DeWitt 2002, table 3.4" },
    { name = "heat given in the last second", unit = "J", source = "closed form, (T1 - T0) m tanh(m L); the same",
      reference = function() return (hot - air) * m * (1 - math.exp(-2 * m)) / (1 + math.exp(-2 * m)) end },
  },
  space = { 8, 16, 32 },
  order = { space = 2 },
  tolerance = 1e-4,
  why = "order 2, 1e-3 with 32 cells",
  forces = { conduction = { "edges", "section", "held", "channel", "account", "capacity", "conductivity" } },
  quick = { space = { 4, 8, 16 }, tolerance = 2e-3 },
  solve = function(at)
    local n = at.n
    local scene, ids, masses = bar.scene { n = n, duration = T, held = { 0 }, law = { capacity = 1, conductivity = 1 },
      enthalpy = function(k) return k == 0 and hot or air end }
    local areas, particles = {}, {}
    for k = 0, n do particles[k + 1], areas[k + 1] = ids[k], masses[k] end
    table.remove(particles, 1) -- the foot is held: what its sides give is not seen
    local foot = table.remove(areas, 1)
    scene:force("heating", { particles = particles, area = areas, convection = m * m, surroundings = air, capacity = 1,
      channel = "enthalpy", account = "given" })
    local before = scene:run { to = T - 1 }:state():channel("given", ids[0])
    local state = scene:run { to = T }:state()
    local given = masses[0] * (state:channel("given", ids[0]) - before) + foot * m * m * (hot - air)
    return { state:channel("enthalpy", ids[n]) - air, given }
  end,
}
