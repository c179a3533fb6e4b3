-- Two boxes on hinges, one on the other, swing far. With p and q the angles of both from the vertical (Landau and Lifshitz,
-- Mechanics, section 5, with moments of inertia): the Lagrangian's equations, extrapolated.
local validation = require("validation")
local numerics = require("numerics")

local g, m, n, l, b, t = 9.81, 2, 1, 0.8, 0.6, 2 -- m/s^2, kg, kg, m, m, s
local function moment(mass, length) return mass * (length ^ 2 + 0.1 ^ 2) / 12 end
local J, K = moment(m, l), moment(n, b)

local function slope(_, y)
  local p, q, u, w = table.unpack(y)
  local A, B, C = J + m * l * l / 4 + n * l * l, n * l * b / 2 * math.cos(p - q), K + n * b * b / 4
  local s = n * l * b / 2 * math.sin(p - q)
  local P, Q = -s * w * w - (m / 2 + n) * g * l * math.sin(p), s * u * u - n * g * b / 2 * math.sin(q)
  local by = A * C - B * B
  return { u, w, (C * P - B * Q) / by, (A * Q - B * P) / by }
end

local ends
local function reference(k) return function()
  ends = ends or numerics.ode(slope, 0, { 2, 1, 0, 0 }, t)
  return k == 3 and ends[2] - ends[1] or ends[k]
end end

return validation.problem {
  title = "Double pendulum of boxes by rk4",
  quantities = {
    { name = "first angle", unit = "rad", reference = reference(1), source = "Lagrange's equations, extrapolated to 1e-12" },
    { name = "second angle in the first", unit = "rad", reference = reference(3), source = "the same" },
  },
  together = true,
  time = { 0.008, 0.004, 0.002 },
  order = { time = 4 },
  tolerance = 1e-7,
  why = "errors of order 4 leave those of order 5",
  quick = { time = { 0.02, 0.01, 0.005 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "rk4" }
    local function box(mass, length, from, angle)
      local to = { from[1] + length * math.sin(angle), from[2], from[3] - length * math.cos(angle) }
      return to, scene:rigid { shape = "box", size = { 0.1, 0.1, length }, mass = mass, orientation = { 0, -angle, 0 },
        position = { (from[1] + to[1]) / 2, 0, (from[3] + to[3]) / 2 } }
    end
    local elbow, first = box(m, l, { 0, 0, 0 }, 2)
    local _, second = box(n, b, elbow, 1)
    local shoulder = scene:joint { kind = "hinge", a = first, at = { 0, 0, 0 }, axis = { 0, -1, 0 } }
    local joint = scene:joint { kind = "hinge", a = second, b = first, at = elbow, axis = { 0, -1, 0 } }
    scene:force("gravity", { g = { 0, 0, -g } })
    local state = scene:run():state()
    return { 2 + shoulder:angle(state), joint:angle(state) - 1 }
  end,
}
