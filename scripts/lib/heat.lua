-- heat: enthalpies, the state of what warms and melts, by temperatures, and back. J/kg and K; 0 is the solid at the solidus,
-- or at 0 K what does not melt. A law is the name of a material, or a table with the names of the force conduction.
local heat = {}

local function law_of(law)
  if type(law) ~= "string" then return law end
  local material = require("material_numbers")[law]
  if not (material and material.conduction) then
    error(("heat: '%s' is no material that conducts heat; scripts/lib/material_numbers.lua has them"):format(law), 3)
  end
  return material.conduction
end

-- At the temperature T; where one melting point is both, molten = 0 to 1 says how much of it is molten (0).
function heat.enthalpy(law, T, molten)
  law = law_of(law)
  if not law.solidus then return law.capacity * T end
  local liquidus = law.liquidus or law.solidus
  if T < law.solidus then return law.capacity * (T - law.solidus) end
  if T > liquidus then return law.latent + (law.capacity_liquid or law.capacity) * (T - liquidus) end
  if liquidus == law.solidus then return (molten or 0) * law.latent end
  return law.latent * (T - law.solidus) / (liquidus - law.solidus)
end

function heat.temperature(law, h)
  law = law_of(law)
  if not law.solidus then return h / law.capacity end
  local liquidus = law.liquidus or law.solidus
  if h < 0 then return law.solidus + h / law.capacity end
  if h > law.latent then return liquidus + (h - law.latent) / (law.capacity_liquid or law.capacity) end
  return law.solidus + (liquidus - law.solidus) * h / law.latent
end

-- Measures "balance": the enthalpy of the particles `ids`, J, by the channel "enthalpy", less what the channel "given" says that
-- they were given. It stays.
function heat.measure_balance(scene, ids)
  scene:measure("balance", function(s)
    local sum = 0
    for _, id in ipairs(ids) do sum = sum + s:mass(id) * (s:channel("enthalpy", id) - s:channel("given", id)) end
    return sum
  end)
end

return heat
