-- References for rigid bodies: Euler's equations with the attitude as a quaternion, I w' = I w x w + r x F, q' = q (0, w)/2,
-- for a body with the principal moments I, under the force F at the point r from the centre of the moments; by
-- numerics.ode, to some 13 digits. w and r are in the frame of the body, F in that of space.
local numerics = require("numerics")
local validation = require("validation")

local bodies = {}

local function cross(a, b)
  return { a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1] }
end

-- The rotation matrix by rows of the quaternion w, x, y, z.
function bodies.matrix(w, x, y, z)
  return {
    { 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y) },
    { 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x) },
    { 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y) },
  }
end

-- v in the frame of the body whose attitude is R.
function bodies.inside(R, v)
  local to = {}
  for k = 1, 3 do to[k] = R[1][k] * v[1] + R[2][k] * v[2] + R[3][k] * v[3] end
  return to
end

-- The attitude at the time t, by rows; it starts as the quaternion q with the spin w.
function bodies.attitude(I, q, w, t, r, F)
  local function slope(_, y)
    local a, b, c, d, w1, w2, w3 = table.unpack(y)
    local torque = { 0, 0, 0 }
    if F then torque = cross(r, bodies.inside(bodies.matrix(a, b, c, d), F)) end
    return {
      (-b * w1 - c * w2 - d * w3) / 2, (a * w1 + c * w3 - d * w2) / 2, (a * w2 + d * w1 - b * w3) / 2,
      (a * w3 + b * w2 - c * w1) / 2,
      ((I[2] - I[3]) * w2 * w3 + torque[1]) / I[1], ((I[3] - I[1]) * w3 * w1 + torque[2]) / I[2],
      ((I[1] - I[2]) * w1 * w2 + torque[3]) / I[3],
    }
  end
  local y = numerics.ode(slope, 0, { q[1], q[2], q[3], q[4], w[1], w[2], w[3] }, t)
  return bodies.matrix(y[1], y[2], y[3], y[4])
end

-- The attitude of a body in a run, by rows.
function bodies.rows(body, state) return select(2, body:attitude(state)) end

-- Quantities of a problem: the first column of an attitude, where the body's x axis points to.
function bodies.axis(reference, source)
  local list = {}
  for k = 1, 3 do
    list[k] = { name = "x axis, " .. ("xyz"):sub(k, k), reference = function() return reference()[k][1] end, scale = 1, source = source }
  end
  return list
end

-- A free asymmetric top that turns about all three axes, by the method `with`; of: what is the method's own.
function bodies.free_top(with, of)
  local I, w, t = { 1.5, 2, 3 }, { 0.1, 1, 0.2 }, 16
  of.title = "Free asymmetric top by " .. with
  of.quantities = bodies.axis(function() return bodies.attitude(I, { 1, 0, 0, 0 }, w, t) end, "Euler's equations, extrapolated to 1e-13")
  of.together = true
  of.solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = with }
    local body = scene:rigid { mass = 1, inertia = I, spin = w }
    local R = bodies.rows(body, scene:run():state())
    return { R[1][1], R[2][1], R[3][1] }
  end
  return validation.problem(of)
end

return bodies
