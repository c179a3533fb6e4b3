-- cloth_on_heart.lua: a square of cloth falls over a formula, Taubin's heart
-- (x^2 + 9/4 y^2 + z^2 - 1)^3 = x^2 z^3 + 9/80 y^2 z^3, and hangs down in folds. The heart is a mesh of scene:implicit,
-- on whose triangles the cloth rests.
local drape = require("drape")
local N = param("N", 33, "particles along one side", { min = 3, max = 512 })
local size = param("size", 0.03, "of a cell of the heart, m", { min = 0.01, max = 0.1 })
local thickness = param("thickness", 6e-3, "of the cloth in contact, m", { min = 1e-5 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.5 })
local scale = 0.3 -- m
scene:implicit { inside = "below", size = size, position = { 0, 0, 0.4 },
  box = { { -0.4, -0.3, -0.35 }, { 0.4, 0.3, 0.42 } },
  f = function(x, y, z)
    x, y, z = x / scale, y / scale, z / scale
    local a = x * x + 9 / 4 * y * y + z * z - 1
    return a * a * a - (x * x + 9 / 80 * y * y) * z * z * z
  end }
local cloth = drape.sheet(scene, { nx = N, ny = N, width = 1, height = 1, origin = { -0.5, -0.5, 0.85 },
  u = { 1, 0, 0 }, v = { 0, 1, 0 } })
scene:force("drag", { rate = 1 })
drape.contact(scene, contact, { thickness = thickness, friction = 0.3 })

scene:measure("lowest", drape.lowest(cloth:ids()), { unit = "m" })
scene:output("frames", { color = "none", thickness = thickness, from = { 0.9, -1.9, 1.15 }, look_at = { 0, 0, 0.4 },
  fov = 26, ground_height = 0 })
return scene
