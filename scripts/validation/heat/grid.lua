-- Heat on the grid of a liquid at rest, between particles that lie at random: a slab whose one side becomes cold, and
-- Stefan's melting front. Steps get shorter with the squares of cells, so that both errors have order 2.
local box, bar, validation = require("_box"), require("_bar"), require("validation")

local T, X = 0.2, 0.7 -- s; m, of a box of 1 m; the conductivity, capacity, density and heat of melting are 1

local function mean() -- of the slab
  local sum = 0
  for k = 0, 40 do
    local q = (k + 0.5) * math.pi
    sum = sum + 2 / (q * q) * math.exp(-q * q * T)
  end
  return sum
end

local function slab(n)
  local scene, ids = box.scene { n = n, steps = math.ceil(n * n / 4), duration = T, law = { capacity = 1, conductivity = 1 },
    temperatures = { 300, 0 }, enthalpy = function() return 301 end }
  return box.sums(scene:run():state(), ids) - 300
end

local function front(n)
  local function f(q) return q * math.exp(q * q) * bar.erf(q) - 1 / math.sqrt(math.pi) end
  local lambda = require("numerics").root(f, 1e-6, 3)
  local scene, ids = box.scene { n = n, steps = math.ceil(n * n / 4), duration = (X / (2 * lambda)) ^ 2,
    law = { capacity = 1, conductivity = 1, solidus = 100, latent = 1 }, temperatures = { 101, 0 },
    enthalpy = function() return 0 end }
  local state = scene:run():state()
  local sum, given = box.sums(state, ids)
  return box.molten(state, ids, 1), sum / given
end

return validation.problem {
  title = "Heat on the grid of a liquid: a slab, and Stefan's front",
  quantities = {
    { name = "mean temperature of the slab", reference = mean, source = "Carslaw and Jaeger 1959, 3.4, equation 8", noise = 1e-3 },
    { name = "front", unit = "m", reference = X, source = "Carslaw and Jaeger 1959, 11.2, I, equation 19", noise = 4e-3 },
    { name = "enthalpy kept", unit = "of what was given", reference = 1, source = "conservation", tolerance = 1e-12,
      why = "rounding", noise = 1e-12 },
  },
  space = { 16, 32, 64 },
  tolerance = 1e-3,
  why = "a part of a cell, which is 1/64, and of the chance by which particles lie",
  forces = { grid_conduction = { "low", "high", "cell", "density", "channel", "account", "temperatures", "capacity",
    "conductivity", "solidus", "latent" } },
  quick = { space = { 8, 12, 16 }, tolerance = 8e-3 },
  solve = function(at)
    local place, kept = front(at.n)
    return { slab(at.n), place, kept }
  end,
}
