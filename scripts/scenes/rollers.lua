-- rollers.lua: two rollers close on a hanging sheet from both sides, one above the other, so that it runs between them in
-- an S. Then they turn against each other, and friction hauls the cloth through; its upper edge is paid out as fast as
-- that, and let go at 1.2 s.
local drape = require("drape")
local N = param("N", 17, "particles across the sheet", { min = 3, max = 256 })
local thickness = param("thickness", 5e-3, "of the cloth in contact, m", { min = 1e-5 })
local friction = param("friction", 0.8, "Coulomb's mu", { min = 0 })
local speed = param("speed", 8, "of the rollers from 0.6 s on, rad/s")
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.4 })
local R = 0.08
local function turned(t) -- rad
  local since = math.max(0, t - 0.6)
  return since < 0.3 and speed * since ^ 2 / 0.6 or speed * (since - 0.15)
end
for side = -1, 1, 2 do
  scene:body { shape = "cylinder", radius = R, length = 0.5, detail = 5e-3, orientation = { math.pi / 2, 0, 0 },
    position = { side * (R + 0.04), 0, 0.3 - 0.09 * side },
    path = function(t)
      local s = math.min(t / 0.5, 1)
      return -side * 0.07 * s * s * (3 - 2 * s), 0, 0
    end,
    rotation = function(t) return 0, side * turned(t), 0 end }
end
local M = 2 * (N - 1) + 1
local cloth = drape.sheet(scene, { nx = N, ny = M, width = 0.36, height = 0.72, origin = { 0, -0.18, 0.13 },
  u = { 0, 1, 0 }, v = { 0, 0, 1 } })
local upper = {}
for i = 1, N do upper[i] = cloth:at(i, M) end
scene:pin(upper, { release = 1.2, path = function(t) return 0, 0, -R * turned(t) end })
scene:force("drag", { rate = 1 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

scene:measure("height of the upper edge", function(s) return s:position(upper[1])[3] end, { unit = "m" })
scene:output("frames", { color = "none", plain = { 0.45, 0.6, 0.4 }, thickness = thickness, particles = "off",
  from = { 0.9, -1.5, 0.85 }, look_at = { 0, 0, 0.3 }, fov = 40, ground_height = -0.6 })
return scene
