-- A box that is spun about its middle axis turns over, again and again (Dzhanibekov): the time between two moments at which
-- the spin about that axis is 0 is 2 K(k)/n, with n and k of Landau and Lifshitz, Mechanics, section 37.
local validation = require("validation")
local numerics = require("numerics")
local bodies = require("_bodies")

local size, mass, w = { 3, 2, 1 }, 12, { 0.02, 1, 0.01 } -- m, kg, rad/s
local I = { 5, 10, 13 } -- kg m^2

local function reference()
  local twice_T, square_L = 0, 0
  for k = 1, 3 do twice_T, square_L = twice_T + I[k] * w[k] ^ 2, square_L + (I[k] * w[k]) ^ 2 end
  local a, c = I[1], I[3]
  if square_L < twice_T * I[2] then a, c = c, a end
  local n = math.sqrt((c - I[2]) * (square_L - twice_T * a) / (I[1] * I[2] * I[3]))
  local k = math.sqrt((I[2] - a) * (twice_T * c - square_L) / ((c - I[2]) * (square_L - twice_T * a)))
  return 2 * numerics.ellipk(k) / n
end

return validation.problem {
  title = "A box spun about its middle axis turns over",
  quantities = { { name = "half period", unit = "s", reference = reference,
    source = "elliptic integral (Landau and Lifshitz, Mechanics, 37)" } },
  time = { 0.08, 0.04, 0.02 },
  order = { time = 2 },
  tolerance = 2e-6,
  why = "errors of order 2 leave those of order 4: (w h)^4 = 2e-7 at the finest step, some of them in the slow passage",
  quick = { time = { 0.4, 0.2, 0.1 }, tolerance = 1e-2 },
  solve = function(at)
    local steps = math.ceil(70 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local body = scene:rigid { shape = "box", size = size, mass = mass, spin = w }
    local zeros = validation.crossings()
    validation.each(scene, at.h, steps, function(s, t)
      local own = bodies.inside(bodies.rows(body, s), body:spin(s))
      zeros(t, own[2], (I[3] - I[1]) * own[3] * own[1] / I[2])
      return #zeros.times == 3
    end)
    return (zeros.times[3] - zeros.times[1]) / 2
  end,
}
