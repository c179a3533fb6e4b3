-- When the spin of a free top has come back in the frame of the body, the body is turned about its angular momentum L, by
-- 2 E T/L less the solid angle that L has gone round in the body (Montgomery 1991, Am. J. Phys. 59, 394). T and the solid
-- angle are integrals over the closed curve of L, where w = (a cos x, b sin x, w3(x)).
local validation = require("validation")
local numerics = require("numerics")
local bodies = require("_bodies")

local I, w = { 1.5, 2, 3 }, { 0.5, 0, 1 } -- kg m^2, rad/s
local twice_E, L = 0, 0
for k = 1, 3 do twice_E, L = twice_E + I[k] * w[k] ^ 2, L + (I[k] * w[k]) ^ 2 end
L = math.sqrt(L)
local excess = twice_E * I[3] - L * L
local a, b = math.sqrt(excess / (I[1] * (I[3] - I[1]))), math.sqrt(excess / (I[2] * (I[3] - I[2])))

local function w3(x) return math.sqrt((twice_E - I[1] * (a * math.cos(x)) ^ 2 - I[2] * (b * math.sin(x)) ^ 2) / I[3]) end
local function round(f) return 4 * numerics.integrate(f, 0, math.pi / 2) end

local T = round(function(x) return I[1] * a / ((I[3] - I[2]) * b * w3(x)) end)
local function solid_angle()
  local p, q = I[1] * a, I[2] * b
  return round(function(x)
    return (1 - I[3] * w3(x) / L) * p * q / ((p * math.cos(x)) ^ 2 + (q * math.sin(x)) ^ 2)
  end)
end

return validation.problem {
  title = "How far a free top is turned when its spin has come back",
  quantities = {
    { name = "angle, less whole turns", unit = "rad", reference = function() return (twice_E * T / L - solid_angle()) % (2 * math.pi) end,
      source = "Montgomery 1991, Am. J. Phys. 59, 394" },
  },
  time = { T / 50, T / 100, T / 200 },
  order = { time = 4 },
  tolerance = 1e-6,
  why = "errors of order 4 leave those of order 6: (w h)^6 T = 1e-6 at the finest step",
  quick = { time = { T / 25, T / 50, T / 100 }, tolerance = 1e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 1 / T, dt = at.h, integrator = "blanes_moan" }
    local body = scene:rigid { mass = 1, inertia = I, spin = w }
    -- The body's y axis is perpendicular to L at the start; n is L's direction, u = n x y.
    local n, R = { I[1] * w[1] / L, 0, I[3] * w[3] / L }, bodies.rows(body, scene:run():state())
    local u = { -n[3], 0, n[1] }
    return math.atan(R[1][2] * u[1] + R[3][2] * u[3], R[2][2]) % (2 * math.pi)
  end,
}
