-- A free symmetric top: its axis goes round the angular momentum L at the rate L/I1 while the body turns about its axis at
-- (1 - I3/I1) w3, so that its attitude is the product of two rotations (Landau and Lifshitz, Mechanics, section 33).
local validation = require("validation")
local bodies = require("_bodies")

local I1, I3, w = 2, 3, { 0.3, 0, 1 }
local t = 12

local function reference()
  local L = { I1 * w[1], 0, I3 * w[3] }
  local size = math.sqrt(L[1] ^ 2 + L[3] ^ 2)
  local half, own = size / I1 * t / 2, (1 - I3 / I1) * w[3] * t
  local s = math.sin(half) / size
  local R = bodies.matrix(math.cos(half), s * L[1], s * L[2], s * L[3])
  local x = {}
  for k = 1, 3 do x[k] = { R[k][1] * math.cos(own) + R[k][2] * math.sin(own) } end
  return x
end

return validation.problem {
  title = "Free symmetric top",
  quantities = bodies.axis(reference, "closed form (Landau and Lifshitz, Mechanics, 33)"),
  together = true,
  time = { 0.04, 0.02, 0.01 },
  order = { time = 2 },
  tolerance = 1e-6,
  why = "errors of order 2 leave those of order 4: (w h)^4 t = 1e-7",
  quick = { time = { 0.2, 0.1, 0.05 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local body = scene:rigid { mass = 2, inertia = { I1, I1, I3 }, spin = w, velocity = { 1, 0, 0 } }
    local R = bodies.rows(body, scene:run():state())
    return { R[1][1], R[2][1], R[3][1] }
  end,
}
