-- Ice at its melting point, of which one side is kept above it: the place of the front, by how much is molten, and what
-- is kept of the enthalpy. The front goes from particle to particle, and its place trembles by a part of their distance.
local bar, validation = require("_bar"), require("validation")

local number, X = 1, 0.7 -- capacity x temperature difference/latent heat; m, of a bar of 1 m

local function lambda(Ste)
  local function f(q) return q * math.exp(q * q) * bar.erf(q) - Ste / math.sqrt(math.pi) end
  return require("numerics").root(f, 1e-6, 3)
end

return validation.problem {
  title = "Stefan's melting front",
  quantities = {
    { name = "front", unit = "m", reference = X, source = "Carslaw and Jaeger 1959, 11.2, I, equation 19", noise = 4e-3 },
    { name = "enthalpy kept", unit = "of what there was", reference = 1, source = "conservation", tolerance = 1e-12,
      why = "rounding", noise = 1e-12 },
  },
  space = { 16, 32, 64, 128 },
  tolerance = 1e-3,
  why = "a part of the distance of particles, which is 1/128",
  forces = { conduction = { "edges", "section", "held", "channel", "account", "capacity", "conductivity", "solidus", "latent" } },
  quick = { space = { 8, 16, 32 }, tolerance = 5e-3 },
  solve = function(at)
    local latent = 1 / number
    local T = (X / (2 * lambda(number))) ^ 2
    local scene, ids, masses = bar.scene { n = at.n, duration = T, held = { 0 },
      law = { capacity = 1, conductivity = 1, solidus = 100, latent = latent },
      enthalpy = function(k) return k == 0 and latent + 1 or 0 end }
    local state = scene:run():state()
    return { bar.molten(state, ids, masses, latent), bar.kept(state, ids, masses) / (masses[0] * (latent + 1)) }
  end,
}
