-- A particle on a spring is brought from rest to 1 m, at rest there, by the least effort: J = d W^-1 d with the Gramian W.
local validation = require("validation")

local m, k, T = 2, 18, 2
local w = math.sqrt(k / m)
local a = (T / 2 - math.sin(2 * w * T) / (4 * w)) / (m * w) ^ 2
local b = math.sin(w * T) ^ 2 / (2 * w) / (m * m * w)
local c = (T / 2 + math.sin(2 * w * T) / (4 * w)) / m ^ 2

return validation.problem {
  title = "An oscillator by the least effort",
  quantities = {
    { name = "cost", unit = "N^2 s", reference = c / (a * c - b * b),
      source = "closed form, d^T W^-1 d, W the integral of (sin ws/(m w), cos ws/m)^T times itself (Kalman, 1960)" },
  },
  space = { 11, 21, 41 },
  space_label = "1/knots",
  tolerance = 1e-6,
  why = "knots d apart cost (w d)^4/720 of it more, which goes by sixteen with each level: 7e-7 at the finest, extrapolated",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "knots=" .. at.n }, script = [[
      local scene = hooke.scene { duration = 2, fps = 20, integrator = "rk4", dt = 0.0125 }
      local push = scene:control("push", { knots = param("knots", 11) })
      local p = scene:particle { position = { 0, 0, 0 }, mass = 2 }
      scene:force("field", { f = function(t) return push(t), 0, 0 end })
      scene:force("central", { strength = 18, per = "particle" })
      scene:goal { particle = p, position = { 1, 0, 0 }, velocity = { 0, 0, 0 } }
      return scene]] }
  end,
  solve = function(at) return at.found.optima[1].cost end,
}
