-- smoke.lua: puffs of warm smoke rise from a chimney, spread as they age, and are carried away and rolled up by gusty
-- wind. Each puff cools towards the air around it, and its lift goes with its heat. Colours: temperature.
local rate = param("rate", 3500, "puffs per second", { min = 1, max = 1e6 })
local wind = param("wind", 1.3, "speed of the wind, m/s", { min = 0 })

local scene = hooke.scene { duration = 6, fps = 60, dt = 1 / 120, integrator = "leapfrog" }
local air, hot, drag = 293, 350, 1.6 -- K, K, 1/s

scene:channel("temperature", { initial = air })
scene:channel("radius", { initial = 0.02 })
scene:source("emitter", { rate = rate, shape = "disc", extent = 0.12, position = { 0, 0, 0.9 }, cone = 16, speed = 1.1,
  speed_spread = 0.35, lifetime = 4.5, lifetime_spread = 0.3, distribution = "lognormal", mass = 1e-5, radius = 0.02,
  radius_spread = 0.3, channel = "temperature", amount = hot, amount_spread = 0.06, capacity = 40000 })

scene:force("relax", { channel = "temperature", rate = 0.7, target = { air } })
scene:force("relax", { channel = "radius", growth = 0.03, label = "spreads" })
scene:force("buoyancy", { ambient = air })

-- The air moves in gusts, and whirls about a line that drifts with them.
scene:force("wind", { on = "particles", rate = drag,
  velocity = hooke.gust { mean = { wind, 0, 0 }, amplitude = { 0.4, 0.4, 0.1 }, shortest = 1.2, seed = 5 } })
scene:force("vortex", { strength = 3, core = 0.5, axis = { 0, 1, 0 }, rate = drag, relative = false,
  center = function(t) return wind * (t - 1), 0, 2.4 end })

scene:measure("height", function(s)
  local sum = 0
  for _, id in ipairs(s:ids()) do sum = sum + s:position(id)[3] end
  return s.n > 0 and sum / s.n or 0
end, { unit = "m" })
scene:output("frames", { width = 1280, height = 720, color = "temperature", unit = "K", range = { 250, hot },
  map = "grey", style = "soft", size = "radius", opacity = 0.12, from = { 1.2, -9.5, 2 }, look_at = { 2.1, 0, 2.1 },
  ground_height = 0 })
return scene
