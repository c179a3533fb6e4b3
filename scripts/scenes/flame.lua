-- flame.lua: hot gas leaves a burner, rises by its buoyancy, cools and burns away; a draught makes it flicker, and the air
-- that streams in closes it at its tip. Colours: temperature, from 500 K to 1700 K.
local rate = param("rate", 9000, "particles per second", { min = 1, max = 1e6 })
local hot = param("hot", 1700, "temperature of the burning gas, K", { min = 300 })

local scene = hooke.scene { duration = 4, fps = 60, dt = 1 / 240, integrator = "leapfrog" }
local air = 293

scene:channel("temperature", { initial = air })
scene:channel("radius", { initial = 0.02 })
scene:source("emitter", { rate = rate, shape = "disc", extent = 0.12, position = { 0, 0, 0 }, cone = 50, speed = 0.9,
  speed_spread = 0.5, lifetime = 0.85, lifetime_spread = 0.5, mass = 1e-5, radius = 0.055, radius_spread = 0.4,
  channel = "temperature", amount = hot, amount_spread = 0.05 })

scene:force("relax", { channel = "temperature", rate = 1.5, target = { air } })
scene:force("relax", { channel = "radius", rate = 1.6, label = "burns away" })
scene:force("buoyancy", { ambient = air, g = { 0, 0, -1.6 } }) -- part of gravity: what rises drags cold air along
scene:force("drag", { rate = 3 })

-- Air streams in from all sides to replace what has risen.
scene:force("central", { axis = { 0, 0, 1 }, strength = 22, power = 1 }) -- 1/s^2

scene:force("gravity", { label = "draught", g = function(t)
  return 3 * math.sin(7.1 * t) + 2.5 * math.sin(16.3 * t), 3 * math.sin(9.7 * t + 1), 0
end })

scene:measure("mean K", function(s)
  local sum = 0
  for _, id in ipairs(s:ids()) do sum = sum + s:channel("temperature", id) end
  return s.n > 0 and sum / s.n or air
end, { unit = "K" })
scene:output("frames", { width = 1280, height = 720, color = "temperature", unit = "K", range = { 500, hot },
  map = "fire", style = "glow", size = "radius", from = { 0, -3.4, 0.7 }, look_at = { 0, 0, 0.6 }, ground = false,
  background = { 0.02, 0.02, 0.03 } })
return scene
