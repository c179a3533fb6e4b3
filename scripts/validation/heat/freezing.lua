-- Water at 5 C freezes from a wall at -20 C, with the conductivities and capacities of ice and water and one density: the
-- thickness of the ice after a time.
local bar, validation = require("_bar"), require("validation")
local ice = require("material_numbers").ice.conduction

local wall, water, X = ice.solidus - 20, ice.solidus + 5, 0.3 -- K; m, of a bar of 1 m and 1 kg/m^3

local function lambda()
  local a, b = ice.conductivity / ice.capacity, ice.conductivity_liquid / ice.capacity_liquid
  local cold, warm = ice.solidus - wall, water - ice.solidus
  local function f(q)
    local p = q * math.sqrt(a / b)
    return q * ice.latent * math.sqrt(math.pi) / (ice.capacity * cold) - math.exp(-q * q) / bar.erf(q)
      + ice.conductivity_liquid / ice.conductivity * math.sqrt(a / b) * warm / cold * math.exp(-p * p) / (1 - bar.erf(p))
  end
  return require("numerics").root(f, 1e-3, 2), a
end

return validation.problem {
  title = "Neumann's freezing front of water",
  quantities = {
    { name = "thickness of the ice", unit = "m", reference = X, source = "Carslaw and Jaeger 1959, 11.2, II, equation 34", noise = 2e-3 },
  },
  space = { 16, 32, 64, 128 },
  tolerance = 1e-3,
  why = "a part of the distance of particles, which is 1/128 of the bar",
  forces = { conduction = { "edges", "section", "held", "channel", "account", "capacity", "conductivity", "solidus", "latent",
    "capacity_liquid", "conductivity_liquid" } },
  quick = { space = { 16, 24, 32 }, tolerance = 5e-3 },
  solve = function(at)
    local q, a = lambda()
    local scene, ids, masses = bar.scene { n = at.n, duration = (X / (2 * q)) ^ 2 / a, held = { 0 }, law = ice,
      enthalpy = function(k)
        return k == 0 and ice.capacity * (wall - ice.solidus) or ice.latent + ice.capacity_liquid * (water - ice.solidus)
      end }
    return 1 - bar.molten(scene:run():state(), ids, masses, ice.latent)
  end,
}
