-- crane.lua: a crane drives a load that hangs on a rope 5 m to the side, and both come to rest: the drive that does it with the least
-- effort swings the load ahead, lets it swing back, and is found by
--   hooke optimise crane.lua
local scene = hooke.scene { duration = 6, fps = 20, integrator = "leapfrog", dt = 5e-3 }
local drive = scene:control("drive", { knots = 25, help = "force on the trolley, N", start = { 54.111, 43.426, 36.556,
  33.824, 34.589, 37.476, 40.700, 42.448, 41.212, 36.070, 26.885, 14.378, 0, -14.378, -26.885, -36.070, -41.212, -42.448, -40.700,
  -37.476, -34.589, -33.824, -36.556, -43.426, -54.111 } })
local k, m = 2e4, 20 -- N/m, kg
local g = param("g", 9.81, "m/s^2", { min = 0 })
local trolley = scene:particle { position = { 0, 0, 0 }, mass = 50 }
local load = scene:particle { position = { 0, 0, -4 - m * g / k }, mass = m }
scene:pin({ trolley }, { axes = { 1, 0, 0 } })
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = { { trolley, load } }, k = k, damping = 200, rest = 4 })
scene:force("field", { f = function(t, _, _, _, _, _, _, id) return id == trolley and drive(t) or 0, 0, 0 end })
scene:measure("trolley", function(s) return s:position(trolley)[1] end, { unit = "m" })
scene:measure("trolley_speed", function(s) return s:velocity(trolley)[1] end, { unit = "m/s" })
scene:measure("load", function(s) return s:position(load)[1] end, { unit = "m" })
scene:measure("load_speed", function(s) return s:velocity(load)[1] end, { unit = "m/s" })
for j, measure in ipairs { "trolley", "trolley_speed", "load", "load_speed" } do
  scene:goal { measure = measure, value = j % 2 * 5 }
end
return scene
