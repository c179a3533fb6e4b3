-- Kovalevskaya's top: I1 = I2 = 2 I3 about the joint, the centre of mass in the plane of the first two axes. Beside energy
-- and angular momentum about the vertical it keeps (w1^2 - w2^2 - c g1)^2 + (2 w1 w2 - c g2)^2, with c = m g l/I3 and the
-- vertical (g1, g2, g3) in the frame of the body (Kowalevski, Acta Mathematica 12 (1889) 177).
local validation = require("validation")
local bodies = require("_bodies")

local m, l, g = 1, 0.5, 2 -- kg, m, m/s^2; moments about the joint: 2, 2 and 1 kg m^2
local c = m * g * l

local function invariant(R, w)
  local own, up = bodies.inside(R, w), R[3]
  return (own[1] ^ 2 - own[2] ^ 2 - c * up[1]) ^ 2 + (2 * own[1] * own[2] - c * up[2]) ^ 2
end

return validation.problem {
  title = "Kovalevskaya's top",
  quantities = {
    { name = "change of the invariant", reference = 0, scale = 1, source = "Kowalevski 1889" },
    { name = "change of the energy", unit = "J", reference = 0, scale = 1, source = "conservation" },
  },
  time = { 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "errors of order 2 leave those of order 4 and the frames at which the largest are seen",
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = 12, fps = 25, dt = at.h, integrator = "leapfrog" }
    local body = scene:rigid { mass = m, inertia = { 2, 2 - m * l * l, 1 - m * l * l }, position = { l, 0, 0 },
      spin = { 0.4, 0.6, 1.1 }, velocity = { 0, 1.1 * l, -0.6 * l } }
    scene:joint { kind = "ball", a = body, at = { 0, 0, 0 } }
    scene:force("gravity", { g = { 0, 0, -g } })
    local first, energy, worst, drift = nil, nil, 0, 0
    scene:on_frame(function(s)
      local now = invariant(bodies.rows(body, s), body:spin(s))
      first, energy = first or now, energy or s:energy()
      worst, drift = math.max(worst, math.abs(now - first)), math.max(drift, math.abs(s:energy() - energy))
    end)
    scene:run()
    return { worst, drift }
  end,
}
