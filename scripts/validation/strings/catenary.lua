-- The shape of a hanging chain of rigid bars: its sag, and the distance of a quarter of its length from the middle, against
-- the catenary z = a cosh(x/a), L = 2 a sinh(1/(2 a)).
local validation = require("validation")
local numerics = require("numerics")
local hang = require("_hang")

local function sinh(x) return (math.exp(x) - math.exp(-x)) / 2 end
local function cosh(x) return (math.exp(x) + math.exp(-x)) / 2 end
local function asinh(x) return math.log(x + math.sqrt(x * x + 1)) end

local a = numerics.root(function(x) return 2 * x * sinh(0.5 / x) - hang.length end, 0.2, 5)

return validation.problem {
  title = "Shape of a catenary",
  quantities = {
    { name = "sag", unit = "m", reference = a * (cosh(0.5 / a) - 1), source = "closed form (Bernoulli, Leibniz, Huygens 1691)" },
    { name = "x at a quarter", unit = "m", reference = a * asinh(hang.length / 4 / a), source = "closed form" },
  },
  space = { 8, 16, 32, 64 },
  order = { space = 2 },
  noise = 1e-10, -- of the speed at which the chain counts as resting
  tolerance = 1e-6,
  why = "errors of order 2, 1e-4 at n = 64, leave those of order 4, 1/n^4 and some times that",
  quick = { space = { 4, 8, 16 }, tolerance = 1e-3 },
  solve = function(at)
    local run, ids = hang.rest(at.n, 0.002, function(scene, edges) scene:constraint("bars", { edges = edges }) end)
    local s = run:state()
    return { -s:position(ids[at.n // 2])[3], s:position(ids[3 * at.n // 4])[1] - hang.span / 2 }
  end,
}
