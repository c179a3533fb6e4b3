-- A particle that is thrown and comes back as fast keeps below a ceiling: what Bryson and Denham made of a constraint on the path.
local validation = require("validation")

local ceiling = 0.1 -- m, below 1/6 m: the particle goes along it from 3 l to 1 - 3 l, with forces linear in time before and after

return validation.problem {
  title = "Thrown and back below a ceiling",
  quantities = {
    { name = "cost", unit = "N^2 s", reference = 8 / (9 * ceiling),
      source = "closed form (Bryson and Ho, Applied Optimal Control, 1975, 3.11): u = -2/(3 l) (1 - t/(3 l)) until 3 l" },
    { name = "highest place at knots", unit = "m", reference = ceiling, source = "the ceiling" },
  },
  space = { 11, 21, 41 },
  tolerance = 1e-9,
  noise = 1e-8,
  why = "the corners of the optimum are at knots: rounding in the solution for up to 40 values and as many ranges",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "knots=" .. at.n }, script = ([[
      local knots, l = param("knots", 11), %.17g
      local scene = hooke.scene { duration = 1, fps = knots - 1, integrator = "rk4", dt = 1 / (knots - 1) }
      local push = scene:control("push", { knots = knots, help = "N" })
      local p = scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 } }
      scene:force("field", { f = function(t) return push(t), 0, 0 end })
      scene:measure("x", function(s) return s:position(p)[1] end)
      for k = 1, knots - 2 do scene:goal { measure = "x", max = l, at = k / (knots - 1) } end
      scene:goal { particle = p, position = { 0, 0, 0 }, velocity = { -1, 0, 0 } }
      return scene]]):format(ceiling) }
  end,
  solve = function(at)
    local best, x, highest = at.found.optima[1], 0, 0
    local values, h = best.controls[1].values, 1 / (at.n - 1)
    local v = 1
    for k = 1, #values - 1 do -- a force that is linear between knots: exact
      x, v = x + h * v + h * h * (2 * values[k] + values[k + 1]) / 6, v + h * (values[k] + values[k + 1]) / 2
      highest = math.max(highest, x)
    end
    return { best.cost, highest }
  end,
}
