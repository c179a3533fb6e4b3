-- From rest to rest with a force of at most U, chosen such that it is linear in the middle eight tenths of the time and at its bounds
-- before and after.
local validation = require("validation")

local s = 0.8
local U = 2 / (1 - s * s / 3)

return validation.problem {
  title = "From rest to rest with a bounded force",
  quantities = {
    { name = "cost", unit = "N^2 s", reference = 2 * U * U * (1 - 2 * s / 3),
      source = "closed form (Pontryagin): u = clip(a (T/2 - t), U), distance U T^2/(4 m) (1 - s^2/3), s = U/(a T/2)" },
    { name = "largest force", unit = "N", reference = U, source = "the bound" },
  },
  space = { 11, 21, 41 },
  tolerance = 1e-10,
  noise = 1e-9,
  why = "the corners of the optimum are at knots: rounding in the solution for up to 40 values",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "knots=" .. at.n, ("most=%.17g"):format(U) }, script = [[
      local scene = hooke.scene { duration = 2, fps = 5, integrator = "rk4", dt = 0.05 }
      local most = param("most", 10)
      local push = scene:control("push", { knots = param("knots", 11), min = -most, max = most })
      local p = scene:particle { position = { 0, 0, 0 }, mass = 2 }
      scene:force("field", { f = function(t) return push(t), 0, 0 end })
      scene:goal { particle = p, position = { 1, 0, 0 }, velocity = { 0, 0, 0 } }
      return scene]] }
  end,
  solve = function(at)
    local best = at.found.optima[1]
    return { best.cost, math.max(table.unpack(best.controls[1].values)) }
  end,
}
