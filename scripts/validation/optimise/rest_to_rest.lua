-- A particle of 1 kg goes from rest to rest over 1 m in 1 s by the least integral of the squared force: u = 6 (1 - 2 t).
local validation = require("validation")

return validation.problem {
  title = "From rest to rest by the least effort",
  quantities = {
    { name = "cost", unit = "N^2 s", reference = 12, source = "closed form, 12 m^2 d^2/T^3; block move of Kelly, SIAM Review 59, 2017" },
    { name = "first force", unit = "N", reference = 6, source = "closed form, u = 6 m d/T^2 (1 - 2 t/T)" },
    { name = "iterations", reference = 1, source = "goals are linear in the controls, the cost is a square" },
  },
  space = { 3, 5, 9 },
  tolerance = 1e-11,
  noise = 1e-10,
  why = "the optimum is linear in time, as controls are, and rk4 is exact for it: rounding, 20 steps of it",
  quick = { space = { 3, 5, 9 } },
  asks = function(at)
    return { command = "optimise", words = { "knots=" .. at.n }, script = [[
      local scene = hooke.scene { duration = 1, fps = 8, integrator = "rk4", dt = 1 / 16 }
      local push = scene:control("push", { knots = param("knots", 3) })
      local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
      scene:force("field", { f = function(t) return push(t), 0, 0 end })
      scene:goal { particle = p, position = { 1, 0, 0 }, velocity = { 0, 0, 0 } }
      return scene]] }
  end,
  solve = function(at)
    local best = at.found.optima[1]
    return { best.cost, best.controls[1].values[1], best.iterations }
  end,
}
