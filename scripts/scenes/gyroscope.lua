-- gyroscope.lua: a wheel with its axle level hangs by one end of it on a string, and does not fall: it goes round at
-- m g l/L, nodding a little. The string is a chain of bars; its last particle and the end of the axle are joined by a ball. The
-- measure `round` is the angle that the axle has gone round, `rate` the mean rate in terms of m g l/L.
local spin = param("spin", 150, "rad/s")
local T = param("duration", 6, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 30, dt = 1 / 480, integrator = "kahan_li8" }

local g, l, top = 9.81, 0.12, 1 -- l: from the end of the axle to the wheel
local wheel = scene:rigid { position = { l, 0, 0.5 }, orientation = { 0, math.pi / 2, 0 }, spin = { spin, 0, 0 },
  parts = {
    { shape = "cylinder", radius = 0.09, length = 0.016, density = 7800 },
    { shape = "cylinder", radius = 0.006, length = 2 * l, density = 7800 },
  } }

-- What would make the wheel go round without nodding.
local I = wheel.inertia[1]
for k = 2, 3 do I = math.max(I, wheel.inertia[k]) end
local expected = wheel.mass * g * l / (I * spin)

local n = 6
local string = scene:strand { n = n, from = { 0, 0, top }, to = { 0, 0, 0.5 }, mass = 0.02 }
scene:pin { string:at(1) }
scene:joint { kind = "ball", a = wheel, b = string:at(n), at = { 0, 0, 0.5 } }
scene:force("gravity", { g = { 0, 0, -g } })
scene:constraint("bars", { edges = string:structural() })

local last, round = 0, 0
scene:on_frame(function(s)
  local x, v = wheel:position(s), s:position(string:at(n))
  local angle = math.atan(x[2] - v[2], x[1] - v[1])
  round, last = round + (angle - last + math.pi) % (2 * math.pi) - math.pi, angle
end)
scene:measure("round", function() return round end)
scene:measure("rate", function(s) return s.t > 0 and round / s.t / expected or 1 end)
scene:measure("height", function(s) return wheel:position(s)[3] end, { unit = "m" })
scene:output("frames", { width = 960, height = 540, legend = false, from = { 0.7, -1.3, 0.95 }, look_at = { 0, 0, 0.62 }, fov = 22,
  ground_height = 0.2, tube = 0.003 })
return scene
