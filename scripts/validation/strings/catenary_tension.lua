-- The forces in a hanging chain of rigid bars: the pull H at its lowest point, and the tension sqrt(H^2 + w^2 s^2) at the
-- length s from it, here a quarter of the chain, as the mean of the two bars beside that joint. H = w a, L = 2 a sinh(1/(2 a)).
local validation = require("validation")
local numerics = require("numerics")
local hang = require("_hang")

local a = numerics.root(function(x) return 2 * x * (math.exp(0.5 / x) - math.exp(-0.5 / x)) / 2 - hang.length end, 0.2, 5)
local H = hang.w * a

return validation.problem {
  title = "Tension of a catenary",
  quantities = {
    { name = "horizontal pull", unit = "N", reference = H, source = "closed form (Bernoulli, Leibniz, Huygens 1691)" },
    { name = "tension at a quarter", unit = "N", reference = math.sqrt(H ^ 2 + (hang.w * hang.length / 4) ^ 2),
      source = "closed form, w z from the directrix" },
    { name = "tension of the middle bars", unit = "N", reference = H, source = "closed form" },
  },
  space = { 8, 16, 32, 64 },
  order = { space = 2 },
  noise = 1e-10, -- of the bars' projection, 1e-12 of the size, and of the speed at which the chain counts as resting
  tolerance = 1e-6,
  why = "errors of order 2, 1e-4 at n = 64, leave those of order 4, 1/n^4 and some times that",
  quick = { space = { 4, 8, 16 }, tolerance = 1e-3 },
  solve = function(at)
    local run, ids = hang.rest(at.n, 0.002, function(scene, edges) scene:constraint("bars", { edges = edges }) end)
    local s, quarter, middle = run:state(), at.n // 4, at.n // 2
    local T = s:constraint_forces("bars")
    return { s:force("bars", ids[0])[1], (T[quarter] + T[quarter + 1]) / 2, (T[middle] + T[middle + 1]) / 2 }
  end,
}
