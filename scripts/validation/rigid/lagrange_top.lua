-- Lagrange's top, on a ball joint, let go spinning about its axis alone: the axis falls, rises again to a cusp, and goes
-- round meanwhile. With u = cos of the axis, u' = sqrt(beta (u - u1)(u2 - u)(u3 - u)), so that the period of the nutation
-- is an integral of a smooth function (Goldstein, Classical Mechanics, 5.7).
local validation = require("validation")
local numerics = require("numerics")
local bodies = require("_bodies")

local m, l, g, A, C = 1, 0.5, 9.81, 0.2, 0.1 -- A, C: kg m^2, about the centre of mass
local angle, spin, t = 0.5, 40, 2 -- rad, rad/s, s
local I = { A + m * l * l, A + m * l * l, C }

local a, beta, u2 = C * spin / I[1], 2 * m * g * l / I[1], math.cos(angle)
local root = math.sqrt(a ^ 4 - 4 * beta * (a * a * u2 - beta))
local u1, u3 = (a * a - root) / (2 * beta), (a * a + root) / (2 * beta)

local function nutation()
  local function slowness(s) return 1 / math.sqrt(beta * (u3 - (u1 + u2) / 2 + (u2 - u1) / 2 * math.cos(s))) end
  return 2 * numerics.integrate(slowness, 0, math.pi)
end

local function attitude()
  return bodies.attitude(I, { math.cos(angle / 2), 0, math.sin(angle / 2), 0 }, { 0, 0, spin }, t, { 0, 0, l }, { 0, 0, -m * g })
end

-- The axis goes round at a (u2 - u)/(1 - u^2), which is 0 at the cusps.
local function precession()
  return 2 * numerics.integrate(function(s)
    local u = (u1 + u2) / 2 - (u2 - u1) / 2 * math.cos(s)
    return a * (u2 - u) / ((1 - u * u) * math.sqrt(beta * (u3 - u)))
  end, 0, math.pi)
end

local quantities = {
  { name = "nutation period", unit = "s", reference = nutation, source = "quadrature (Goldstein, Classical Mechanics, 5.7)" },
  { name = "precession per nutation", unit = "rad", reference = precession, source = "the same" },
}
for k = 1, 3 do
  quantities[k + 2] = { name = "axis, " .. ("xyz"):sub(k, k), reference = function() return attitude()[k][3] end, scale = 1,
    source = "Euler's equations, extrapolated to 1e-13" }
end

return validation.problem {
  title = "Lagrange's top",
  quantities = quantities,
  time = { 0.004, 0.002, 0.001 },
  order = { time = 2 },
  tolerance = 3e-6,
  why = "errors of order 2 leave those of order 4: (w h)^4 = 3e-6 for the spin, of which the axis sees a part",
  quick = { time = { 0.01, 0.005, 0.0025 }, tolerance = 2e-3 },
  solve = function(at)
    local steps = math.floor(t / at.h + 0.5)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local up = { math.sin(angle), 0, math.cos(angle) }
    local body = scene:rigid { mass = m, inertia = { A, A, C }, orientation = { 0, angle, 0 }, position = { l * up[1], 0, l * up[3] },
      spin = { spin * up[1], 0, spin * up[3] } }
    scene:joint { kind = "ball", a = body, at = { 0, 0, 0 } }
    scene:force("gravity", { g = { 0, 0, -g } })
    local rises, last, round = validation.crossings(1), nil, {}
    local t0, turned, rate = 0, 0, 0
    local middle = (u1 + u2) / 2
    validation.each(scene, at.h, steps, function(s, now)
      local R, w = bodies.rows(body, s), body:spin(s)
      last = { R[1][3], R[2][3], R[3][3] }
      local flat = last[1] ^ 2 + last[2] ^ 2
      local to = turned + (math.atan(last[2], last[1]) - turned + math.pi) % (2 * math.pi) - math.pi
      local going = w[3] - last[3] * (w[1] * last[1] + w[2] * last[2]) / flat
      if rises(now, last[3] - middle, w[1] * last[2] - w[2] * last[1]) > #round then
        round[#round + 1] = validation.cubic(rises.times[#rises.times], t0, turned, rate, now, to, going)
      end
      t0, turned, rate = now, to, going
    end)
    local times, n = rises.times, #round - 1
    return { (times[n + 1] - times[1]) / n, (round[n + 1] - round[1]) / n, last[1], last[2], last[3] }
  end,
}
