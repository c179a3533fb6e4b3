-- twist.lua: both ends of a sheet are turned against each other, ten turns in all. It winds into a rope, which winds
-- about itself, and every layer stays outside of the others.
local drape = require("drape")
local N = param("N", 11, "particles across the sheet", { min = 3, max = 256 })
local turns = param("turns", 10, "of one end against the other", { min = 0 })
local thickness = param("thickness", 4e-3, "of the cloth in contact, m", { min = 1e-5 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 2.5 })
local M = 4 * (N - 1) + 1
local cloth = drape.sheet(scene, { nx = M, ny = N, width = 0.96, height = 0.24, origin = { -0.48, 0, -0.12 }, density = 0.3,
  stiffness = 150, damping = 0.05, u = { 1, 0, 0 }, v = { 0, 0, 1 } })
local rate = turns * math.pi / 2.5 -- each end turns by half of them
for end_, i in pairs { [-1] = 1, [1] = M } do
  local ids = {}
  for j = 1, N do ids[j] = cloth:at(i, j) end
  scene:pin(ids, { rotation = function(t) return end_ * rate * t, 0, 0 end,
    path = function(t) return -0.03 * end_ * t, 0, 0 end })
end
scene:force("drag", { rate = 3 })
drape.contact(scene, contact, { thickness = thickness, friction = 0.1 })

scene:measure("width in the middle", function(s)
  local r = 0
  for j = 1, N do
    local p = s:position(cloth:at((M + 1) // 2, j))
    r = math.max(r, math.sqrt(p[2] ^ 2 + p[3] ^ 2))
  end
  return 2 * r
end, { unit = "m" })
scene:output("frames", { color = "none", plain = { 0.75, 0.35, 0.3 }, thickness = thickness, particles = "off",
  from = { 0.35, -1.6, 0.5 }, look_at = { 0, 0, 0 }, fov = 26, ground_height = -0.35 })
return scene
