-- tangled.lua: a tongue of cloth curls back, and its tip has gone through itself before the run begins. It is drawn back
-- in the first step, falls, and lies on the floor in a loop that nothing passes through.
local drape = require("drape")
local N = param("N", 9, "particles across the tongue", { min = 5, max = 200 })
local thickness = param("thickness", 4e-3, "of the cloth in contact, m", { min = 1e-5 })
local frees = param("untangle", 1, "0: the start is refused")
local along, straight, radius = 5 * N, 0.5, 0.12
local length = straight + 1.5 * math.pi * radius + 0.2

-- The tongue's middle line: straight ahead, three quarters of a circle upwards, straight down.
local function line(s)
  if s < straight then return s, 0 end
  local turn = math.min((s - straight) / radius, 1.5 * math.pi)
  local down = math.max(0, s - straight - 1.5 * math.pi * radius)
  return straight + radius * math.sin(turn), radius * (1 - math.cos(turn)) - down
end

local vertices, faces = {}, {}
for i = 0, along - 1 do
  local s = length * i / (along - 1)
  local x, z = line(s)
  local half = 0.2 - 0.14 * s / length
  for j = 0, N - 1 do vertices[#vertices + 1] = { x, half * (2 * j / (N - 1) - 1) + 0.03 * s, 0.3 + z } end
end
for i = 0, along - 2 do
  for j = 1, N - 1 do
    local k = i * N + j
    faces[#faces + 1] = { k, k + 1, k + N }
    faces[#faces + 1] = { k + 1, k + N + 1, k + N }
  end
end

local scene = drape.scene("impulses", { duration = 1.2 })
local cloth = scene:mesh { vertices = vertices, faces = faces, density = 0.2 }
scene:force("springs", scene:membrane(cloth, { stiffness = 60, damping = 0.1 }))
scene:force("hinges", { triangles = cloth:triangles(), rigidity = 1e-5, damping = 1e-6 })
scene:force("drag", { rate = 3 })
scene:body { shape = "plane", size = 2, position = { 0.3, 0, 0 } }
scene:corrector("contact", { thickness = thickness, friction = 0.3 })
if frees > 0 then scene:corrector("untangle", { thickness = thickness }) end

scene:measure("lowest", drape.lowest(cloth:ids()), { unit = "m" })
scene:output("frames", { color = "none", thickness = thickness, from = { 0.9, -1.5, 0.75 },
  look_at = { 0.3, 0, 0.2 }, fov = 27, ground_height = 0 })
return scene
