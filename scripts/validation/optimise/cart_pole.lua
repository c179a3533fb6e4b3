-- A cart of 1 kg with a pole of 0.5 m and 0.3 kg goes 1 m to the side in 2 s, and its pole from hanging to standing.
local validation = require("validation")

return validation.problem {
  title = "Cart and pole by the least effort",
  quantities = {
    { name = "cost", unit = "N^2 s", reference = 57.9447803,
      source = "Kelly, SIAM Review 59, 2017, section 6; Pontryagin's equations as a boundary value problem to 1e-9" },
  },
  space = { 41, 81, 161 },
  space_label = "1/knots",
  tolerance = 1e-6,
  why = "an error of order 4 in the distance of knots and steps, 1e-5 at the finest level, extrapolated",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "knots=" .. at.n }, script = [[
      local knots = param("knots", 21)
      local m1, m2, l, g = 1, 0.3, 0.5, 9.81
      local scene = hooke.scene { duration = 2, fps = 20, integrator = "rk4", dt = math.min(0.05, 1 / (knots - 1)) }
      local push = scene:control("push", { knots = knots, help = "N" })
      local p = scene:particle { position = { 0, 0, 0 } }
      scene:force("field", { f = function(t, _, q, _, _, w) -- m of the cart, and the pole's angle
        local u, s, c = push(t), math.sin(q), math.cos(q)
        local d = m1 + m2 * s * s
        return (l * m2 * s * w * w + u + m2 * g * c * s) / d,
          -(l * m2 * c * s * w * w + u * c + (m1 + m2) * g * s) / (l * d), 0
      end })
      scene:goal { particle = p, position = { 1, math.pi, 0 }, velocity = { 0, 0, 0 } }
      return scene]] }
  end,
  solve = function(at) return at.found.optima[1].cost end,
}
