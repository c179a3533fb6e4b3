-- A ball leaves a sphere on which it goes down: without friction where cos a = 2/3 cos a_0. With mu = 1/2 it rolls, then slips,
-- and the equations are integrated. With friction without end it rolls to the end, at cos a = 10/17 cos a_0, where friction ends at
-- once: the speed is known to a step's part of it.
local validation = require("validation")
local numerics = require("numerics")

local g, R, r, start, mu = 9.81, 0.5, 0.1, 0.3, 0.5
local d = R + r

local function pressure(y) return g * math.cos(y[1]) - d * y[2] ^ 2 end
local function slips(_, y) return { y[2], (g * math.sin(y[1]) - mu * pressure(y)) / d, 5 / 2 * mu * pressure(y) } end

-- y when `over` becomes positive.
local function until_(slope, y, over)
  local low, high = 0, 0.2
  while high - low > 1e-14 do
    local middle = (low + high) / 2
    if over(numerics.ode(slope, 0, y, middle)) <= 0 then low = middle else high = middle end
  end
  return numerics.ode(slope, 0, y, low)
end

local known
local function slipping()
  if known then return known end
  -- From rest the ball rolls at first, by its law in closed form: the angle at which it slips is found on it.
  local function at(a) return { a, math.sqrt(10 / 7 * g / d * (math.cos(start) - math.cos(a))) } end
  local low, high = start, math.acos(10 / 17 * math.cos(start))
  for _ = 1, 60 do
    local a = (low + high) / 2
    if 2 / 7 * g * math.sin(a) > mu * pressure(at(a)) then high = a else low = a end
  end
  local y = at(low)
  known = until_(slips, { y[1], y[2], d * y[2] }, function(z) return -pressure(z) end)
  return known
end

local function frictionless()
  local c = 2 / 3 * math.cos(start)
  return math.sqrt(2 * g * d * (math.cos(start) - c)) * c
end

-- Where it rolls to the end, by friction without end, it leaves where cos a = 10/17 cos a_0.
local function rolling()
  local c = 10 / 17 * math.cos(start)
  return math.sqrt(10 / 7 * g * d * (math.cos(start) - c)) * c
end

local function ball(friction, h)
  local scene = hooke.scene { duration = 0.8, fps = 5, dt = h, integrator = "leapfrog" }
  local b = scene:rigid { shape = "sphere", radius = r, mass = 2, position = { d * math.sin(start), 0, d * math.cos(start) } }
  b:surface { { 0, 0, 0 } }
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:corrector("obstacle", { shape = "sphere", size = { 2 * R, 2 * R, 2 * R }, friction = friction, radius = r })
  local s = scene:run():state()
  return b:velocity(s)[1], r * b:spin(s)[2]
end

return validation.problem {
  title = "A ball leaves a sphere",
  quantities = {
    { name = "speed aside, mu = 0", unit = "m/s", reference = frictionless, source = "closed form, cos a = 2/3 cos a_0" },
    { name = "speed aside, mu = 1/2", unit = "m/s", source = "equations of rolling, then of slipping, to 1e-13",
      reference = function() local y = slipping() return d * y[2] * math.cos(y[1]) end },
    { name = "r w, mu = 1/2", unit = "m/s", source = "equations of rolling, then of slipping, to 1e-13",
      reference = function() return slipping()[3] end },
    { name = "speed aside, mu = 1e6", unit = "m/s", reference = rolling, source = "closed form, cos a = 10/17 cos a_0",
      tolerance = 2e-4, noise = 2e-3, why = "friction without end ends within the step in which the ball leaves" },
  },
  time = { 2e-3, 1e-3, 5e-4 },
  tolerance = 1e-5,
  noise = 1e-5,
  why = "order 2, but for the steps in which it slips first and leaves",
  quick = { time = { 8e-3, 4e-3, 2e-3 }, tolerance = 2e-3 },
  solve = function(at)
    local free = ball(0, at.h)
    local v, w = ball(mu, at.h)
    return { free, v, w, (ball(1e6, at.h)) }
  end,
}
