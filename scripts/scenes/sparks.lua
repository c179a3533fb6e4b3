-- sparks.lua: a stream of sparks falls on a tilted steel plate, sprays off it in a fan, and meets the floor, where sparks
-- bounce lower each time, slide and come to rest. Impacts are found inside the steps of 1/240 s, of up to 5 cm of way.
local n = param("n", 3000, "sparks", { min = 1 })
local e = param("e", 0.5, "restitution", { min = 0, max = 1 })
local tilt = param("tilt", 25, "of the plate, degrees", { min = 0, max = 60 })

local scene = hooke.scene { duration = 2.5, fps = 60, dt = 1 / 240, integrator = "leapfrog" }

local function spread(s) return s * (math.random() + math.random() + math.random() - 1.5) end
local positions, velocities = {}, {}
for k = 1, n do -- they reach the plate one after the other, 0.3 to 1.5 s from now
  local late = 0.3 + 1.2 * math.random()
  positions[k] = { spread(0.12), spread(0.12), 0.75 + 9.81 / 2 * late ^ 2 }
  velocities[k] = { spread(0.2), spread(0.2), 0 }
end
scene:particles { positions = positions, velocities = velocities, mass = 1e-6 }

-- The plate is drawn by a pinned sheet on its upper side.
local c, s = math.cos(math.rad(tilt)), math.sin(math.rad(tilt))
local sheet = scene:grid { nx = 2, ny = 2, width = 1, height = 1, u = { c, 0, -s }, v = { 0, 1, 0 },
  origin = { -c / 2, -0.5, 0.7 + s / 2 }, mass = 1, group = "plate" }
scene:pin(sheet:ids())

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("drag", { rate = 0.1 })
scene:corrector("obstacle", { label = "floor", restitution = e, friction = 0.3, radius = 0.006 })
scene:corrector("obstacle", { label = "plate", shape = "box", size = { 1, 1, 0.02 }, rotation = { 0, math.rad(tilt), 0 },
  position = { -0.01 * s, 0, 0.7 - 0.01 * c }, restitution = e, friction = 0.1, radius = 0.006 })

scene:measure("lowest", function(state)
  local low = math.huge
  for id = 1, n do low = math.min(low, state:position(id)[3]) end
  return low
end, { unit = "m" })
scene:output("frames", { width = 1280, height = 720, color = "speed", range = { 0, 8 }, map = "fire", style = "glow",
  streak = 0.02, radius = 0.008, ground_height = 0, from = { 0.4, -6, 2 }, look_at = { 0.9, 0, 0.9 } })
return scene
