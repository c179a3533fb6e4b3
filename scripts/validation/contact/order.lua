-- The order of contact in time. A mass on a spring whose end is below the floor bounces on it, by impulses: between
-- impacts it swings as a cosine. Another one is pressed onto the floor all the time, ever more, and rubbed. And a mass in
-- free flight meets the repulsion of a floor, E = K d^4 at the depth d: it turns round within 2 d/v int_0^1 du/sqrt(1 -
-- u^4), at the depth d = (m v^2/(2 K))^(1/4).
local validation = require("validation")
local numerics = require("numerics")

local w, rest, first, e, radius = 7, -0.3, 0.2, 0.8, 0.01

-- Above the floor after t of y'' = -w^2 (y - rest), from rest at `first`, e of the speed left at each impact.
local function swung(t)
  local y, speed = first - rest, 0
  while true do
    local phase, size = math.atan(-speed / w, y), math.sqrt(y * y + (speed / w) ^ 2) -- y = size cos(w t + phase)
    local next_hit = (math.acos(-rest / size) - phase) / w
    if t < next_hit then return size * math.cos(w * t + phase) + rest end
    speed, y, t = e * w * size * math.sin(w * next_hit + phase), -rest, t - next_hit
  end
end

-- The first impact; levels have it in the middle of a step, so that the error is that of one place in it.
local hit = math.acos(-rest / (first - rest)) / w

local mass, speed, k, reach = 0.1, 0.3, 2000, 5e-3
local depth = (mass * speed ^ 2 / 2 * 12 * reach ^ 2 / k) ^ (1 / 4)
local quarter = numerics.ellipk(math.sqrt(1 / 2)) / math.sqrt(2) -- int_0^1 du/sqrt(1 - u^4)

local function floor(scene) scene:body { shape = "box", size = { 4, 4, 0.1 }, position = { 0, 0, -0.05 } } end

local function impulsive(h)
  local scene = hooke.scene { duration = 2 * hit, fps = 1 / (2 * hit), dt = h, integrator = "leapfrog" }
  floor(scene)
  local p = scene:particle { position = { 0.3, 0.2, radius + first }, mass = mass }
  scene:force("field", { only = { p }, f = function(_, _, _, z) return 0, 0, -mass * w * w * (z - radius - rest) end })
  scene:corrector("contact", { restitution = e, radius = radius })
  return scene:run():state():position(p)[3] - radius
end

-- Pressed onto the floor by a force that grows, with friction, and drawn by a spring along it: y'' = -w^2 y + mu g (1 +
-- t/T), T = grows.
local mu, g, grows, ends = 0.2, 9.81, 0.3, 0.4

local function rubbed(t)
  local a, b = mu * g / w ^ 2, mu * g / (w ^ 2 * grows)
  return (first - a) * math.cos(w * t) - b / w * math.sin(w * t) + a + b * t
end

local function lasting(h)
  local scene = hooke.scene { duration = ends, fps = 1 / ends, dt = h, integrator = "leapfrog" }
  floor(scene)
  local p = scene:particle { position = { first, 0.2, radius }, mass = mass }
  scene:force("field", { only = { p }, f = function(t, x) return -mass * w * w * x, 0, -mass * g * (1 + t / grows) end })
  scene:corrector("contact", { friction = mu, radius = radius })
  return scene:run():state():position(p)[1]
end

local function smooth(h)
  local scene = hooke.scene { duration = 0.2, fps = 20, dt = h, integrator = "leapfrog" }
  floor(scene)
  local p = scene:particle { position = { 0.3, 0.2, radius + reach + 0.02 }, velocity = { 0, 0, -speed }, mass = mass }
  scene:force("repulsion", { radius = radius, reach = reach, stiffness = k })
  local s = scene:run():state()
  local out = s:velocity(p)[3]
  return 0.2 - 0.02 / speed - (s:position(p)[3] - radius - reach) / out, out / speed
end

return validation.problem {
  title = "Contact's order in time",
  quantities = {
    { name = "height after an impact, impulses", unit = "m", reference = swung(2 * hit),
      source = "closed form, cosines before and after it" },
    { name = "place after rubbing, impulses", unit = "m", reference = rubbed(ends),
      source = "closed form, a cosine and a straight line" },
    { name = "time of a smooth impact, repulsion", unit = "s", reference = 2 * depth / speed * quarter,
      source = "closed form, 2 d/v int_0^1 du/sqrt(1 - u^4)" },
    { name = "speed after a smooth impact", reference = 1, source = "closed form: the energy stays",
      tolerance = 1e-6, order = {}, noise = 1e-5, why = "of order 2 with a factor that swings with the step" },
  },
  time = { hit / 20.5, hit / 61.5, hit / 184.5 },
  order = { time = 2 },
  tolerance = 1e-4,
  why = "the errors of order 2 leave those of order 3",
  quick = { time = { hit / 6.5, hit / 19.5, hit / 58.5 }, tolerance = 1e-2 },
  solve = function(at) return { impulsive(at.h), lasting(ends / 60 * at.h * 20.5 / hit), smooth(0.15 * at.h / hit / 6) } end,
}
