-- A pendulum is swung up from rest below to rest above in 4 s by the least integral of the squared torque: q'' = u - sin q.
local numerics = require("numerics")
local validation = require("validation")

-- Pontryagin's equations, u = -b/2, a' = b cos q, b' = -a: q, w and the cost at the end from a and b at the start.
local function shoot(a, b)
  local y = numerics.ode(function(_, y)
    return { y[2], -y[4] / 2 - math.sin(y[1]), y[4] * math.cos(y[1]), -y[3], y[4] ^ 2 / 4 }
  end, 0, { 0, 0, a, b, 0 }, 4)
  return y[1] - math.pi, y[2], y[5]
end

-- By Newton's method from what the finest level says of u and u' at the start, rounded.
local function reference(a, b)
  for _ = 1, 12 do
    local d = 1e-6
    local q, w = shoot(a, b)
    local qa, wa = shoot(a + d, b)
    local qb, wb = shoot(a, b + d)
    local j11, j12, j21, j22 = (qa - q) / d, (qb - q) / d, (wa - w) / d, (wb - w) / d
    local det = j11 * j22 - j12 * j21
    a, b = a - (q * j22 - w * j12) / det, b - (w * j11 - q * j21) / det
  end
  local q, w, cost = shoot(a, b)
  if math.abs(q) + math.abs(w) > 1e-8 then error("the reference does not converge") end
  return cost
end

return validation.problem {
  title = "A pendulum swung up by the least effort",
  quantities = {
    { name = "cost", unit = "N^2 m^2 s", reference = function() return reference(1.6, -2.1) end,
      source = "Pontryagin's equations by shooting to 1e-8" },
  },
  space = { 31, 61, 121 },
  space_label = "1/knots",
  tolerance = 1e-6,
  why = "an error of order 4 in the distance of knots and steps, 1e-6 at the finest level, extrapolated",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "knots=" .. at.n }, script = [[
      local knots = param("knots", 31)
      local scene = hooke.scene { duration = 4, fps = 10, integrator = "rk4", dt = math.min(0.05, 2 / (knots - 1)) }
      local torque = scene:control("torque", { knots = knots })
      local p = scene:particle { position = { 0, 0, 0 } }
      scene:force("field", { f = function(t, q) return torque(t) - math.sin(q), 0, 0 end })
      scene:goal { particle = p, position = { math.pi, 0, 0 }, velocity = { 0, 0, 0 } }
      return scene]] }
  end,
  solve = function(at) return at.found.optima[1].cost end,
}
