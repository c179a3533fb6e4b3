-- flag.lua: a flag flies from its mast until the wind drops. It falls against the mast and in on itself, and its folds
-- come to lie on each other instead of passing through each other.
local drape = require("drape")
local N = param("N", 19, "particles along the height", { min = 3, max = 256 })
local thickness = param("thickness", 5e-3, "of the cloth in contact, m", { min = 1e-5 })
local speed = param("speed", 7, "of the wind, m/s", { min = 0 })
local lull = param("lull", 0.8, "when it drops, s", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 2.5 })
scene:body { shape = "cylinder", radius = 0.02, length = 1.6, position = { -0.03, 0, 0.8 }, detail = 2e-2 }
local M = 3 * (N - 1) // 2 + 1
local flag = drape.sheet(scene, { nx = M, ny = N, width = 0.9, height = 0.6, origin = { 0, 0, 0.95 },
  density = 0.15, rigidity = 2e-5, u = { 1, 0, 0 }, v = { 0, 0, 1 } })
scene:pin { flag:at(1, 1), flag:at(1, N // 2), flag:at(1, N) }
scene:force("wind", { friction = 0.03, velocity = function(t)
  local strength = math.max(0, 1 - math.max(0, t - lull) / 0.4)
  return speed * strength, 0.35 * speed * strength * math.sin(9 * t), 0
end })
drape.contact(scene, contact, { thickness = thickness, friction = 0.3 })

local tip = flag:at(M, 1)
scene:measure("lowest", drape.lowest { tip }, { unit = "m" })
scene:output("frames", { color = "none", plain = { 0.78, 0.3, 0.26 }, thickness = thickness,
  from = { 0.9, -2.5, 1.2 }, look_at = { 0.3, 0, 0.95 }, fov = 28, ground_height = 0 })
return scene
