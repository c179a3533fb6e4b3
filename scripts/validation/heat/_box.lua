-- A plane box of 1 m by four cells, full of particles at rest, between whose cells heat flows along x.
local filling = require("filling")
local box = {}

-- `law` is that of the force grid_conduction; `temperatures` and `fluxes` of its faces at low and high x; `enthalpy(x)` the
-- start; n cells, `steps` of them in `duration`. Returns the scene, ids and the mass of a particle.
function box.scene(o)
  local cell, T = 1 / o.n, o.duration
  local scene = hooke.scene { duration = T, fps = 1 / T, dt = T / o.steps, integrator = o.integrator or "symplectic_euler" }
  scene:channel("enthalpy", { initial = 0 })
  scene:channel("given", { initial = 0 })
  local low, high = { 0, 0, 0 }, { 1, 0, 4 * cell }
  local full = filling.box { low = low, high = high, cell = cell, density = o.density or 1, scatter = o.scatter }
  local ids = {}
  for k, p in ipairs(full.positions) do
    ids[k] = scene:particle { position = p, mass = full.mass, enthalpy = o.enthalpy(p[1]) }
  end
  local faces = function(list) return list and { list[1], list[2], 0, 0, 0, 0 } end
  local params = { low = low, high = high, cell = cell, density = o.density or 1, channel = "enthalpy", account = "given",
    temperatures = faces(o.temperatures), fluxes = faces(o.fluxes) }
  for name, value in pairs(o.law) do params[name] = value end
  scene:force("grid_conduction", params)
  return scene, ids, full.mass, cell
end

-- The part of the particles that is molten.
function box.molten(state, ids, latent)
  local sum = 0
  for _, id in ipairs(ids) do sum = sum + math.max(0, math.min(1, state:channel("enthalpy", id) / latent)) / #ids end
  return sum
end

-- J/kg, means: the enthalpy, and of it what came through faces.
function box.sums(state, ids)
  local sum, given = 0, 0
  for _, id in ipairs(ids) do
    sum, given = sum + state:channel("enthalpy", id) / #ids, given + state:channel("given", id) / #ids
  end
  return sum, given
end

return box
