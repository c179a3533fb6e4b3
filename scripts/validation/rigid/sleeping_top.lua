-- A top that spins upright sleeps while C w > 2 sqrt(A m g l), and falls below that: in the frame that turns at
-- C w/(2 A) the small offset of its axis obeys z'' = s z, s = m g l/A - (C w/(2 A))^2 (Goldstein, Classical Mechanics,
-- 5.7). From what becomes of an offset in two runs, one on each side of the limit, s
-- is known at both; it is linear in w^2, and its zero is the limit.
local validation = require("validation")
local bodies = require("_bodies")

local m, l, g, C, offset, t = 1, 0.5, 9.81, 0.1, 1e-4, 1 -- kg, m, m/s^2, kg m^2, rad, s
local across = 0.2 -- kg m^2, about the centre of mass
local A = across + m * l * l
local limit = 2 * math.sqrt(A * m * g * l) / C

-- cosh(sqrt(s) t), of which the cosine is that of s < 0, of a run with the spin w.
local function growth(w, h)
  local scene = hooke.scene { duration = t, fps = 1 / t, dt = h, integrator = "blanes_moan" }
  local up = { math.sin(offset), 0, math.cos(offset) }
  local rate = C * w / (2 * A)
  local about = w - rate * up[3]
  scene:force("gravity", { g = { 0, 0, -g } })
  local body = scene:rigid { mass = m, inertia = { across, across, C }, orientation = { 0, offset, 0 },
    position = { l * up[1], 0, l * up[3] }, spin = { about * up[1], 0, about * up[3] + rate },
    velocity = { 0, rate * l * up[1], 0 } }
  scene:joint { kind = "ball", a = body, at = { 0, 0, 0 } }
  local R = bodies.rows(body, scene:run():state())
  local turned = rate * t
  return (R[1][3] * math.cos(turned) + R[2][3] * math.sin(turned)) / math.sin(offset)
end

local function rate_squared(w, h)
  local c = growth(w, h)
  if c > 1 then return (math.log(c + math.sqrt(c * c - 1)) / t) ^ 2 end
  return -(math.acos(c) / t) ^ 2
end

return validation.problem {
  title = "The limit of a sleeping top",
  quantities = {
    { name = "least spin that sleeps", unit = "rad/s", reference = limit, source = "closed form, 2 sqrt(A m g l)/C (Goldstein, 5.7)" },
    { name = "growth of the offset at 0.98 of it", unit = "1/s", reference = math.sqrt(m * g * l / A * (1 - 0.98 ^ 2)),
      source = "closed form of the linear equations" },
  },
  time = { 0.01, 0.005, 0.0025 },
  order = { time = 4 },
  tolerance = 1e-7,
  why = "errors of order 4 leave those of order 6, (w h)^6 = 1e-7 of the spin, of which the axis sees a part; the offset squared is 1e-8",
  quick = { time = { 0.02, 0.01, 0.005 }, tolerance = 1e-3 },
  solve = function(at)
    local below, above = rate_squared(0.98 * limit, at.h), rate_squared(1.02 * limit, at.h)
    local zero = 0.98 ^ 2 + (1.02 ^ 2 - 0.98 ^ 2) * below / (below - above)
    return { limit * math.sqrt(zero), math.sqrt(below) }
  end,
}
