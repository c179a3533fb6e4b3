-- An elastic string hangs between two pegs: the elastic catenary. With V = w L/2 at the pegs and the horizontal pull H,
--     span = H L/EA + 2 (H/w) asinh(V/H),   sag = w L^2/(8 EA) + (H/w)(sqrt(1 + (V/H)^2) - 1).
local validation = require("validation")
local numerics = require("numerics")
local hang = require("_hang")

local EA, V = 10, hang.w * hang.length / 2
local function asinh(x) return math.log(x + math.sqrt(x * x + 1)) end
local function span(H) return H * hang.length / EA + 2 * H / hang.w * asinh(V / H) end
local H = numerics.root(function(x) return span(x) - hang.span end, 0.1, 2)

return validation.problem {
  title = "Elastic catenary",
  quantities = {
    { name = "sag", unit = "m", source = "closed form (Irvine, Cable Structures, 1981, ch. 1)",
      reference = hang.w * hang.length ^ 2 / (8 * EA) + H / hang.w * (math.sqrt(1 + (V / H) ^ 2) - 1) },
    { name = "horizontal pull", unit = "N", source = "closed form (Irvine, Cable Structures, 1981, ch. 1)", reference = H },
  },
  space = { 8, 16, 32, 64 },
  order = { space = 2 },
  noise = 1e-11, -- of the speed at which it counts as resting, over the rate of the drag
  tolerance = 1e-6,
  why = "errors of order 2, 3e-4 at n = 64, leave those of order 4, 1/n^4 and some times that",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 4, 8, 16 }, tolerance = 1e-3 },
  solve = function(at)
    local run, ids = hang.rest(at.n, 0.02 / at.n, function(scene, edges, l)
      scene:force("springs", { edges = edges, k = EA / l, rest = l })
    end)
    local s = run:state()
    return { -s:position(ids[at.n // 2])[3], s:force("springs", ids[0])[1] }
  end,
}
