-- stack.lua: ten sheets, each turned a little against the one below, fall on each other and on the floor. Air is
-- pressed out and they come to rest as a stack whose height is that of ten thicknesses.
local drape = require("drape")
local N = param("N", 9, "particles along one side", { min = 3, max = 256 })
local sheets = param("sheets", 10, "how many", { min = 1, max = 100 })
local thickness = param("thickness", 8e-3, "of each in contact, m", { min = 1e-5 })
local friction = param("friction", 0.4, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1 })
scene:body { shape = "plane", size = 2 }
local top
for k = 1, sheets do
  local angle, side = 0.16 * k, 0.5
  local c, s = math.cos(angle), math.sin(angle)
  top = drape.sheet(scene, { nx = N, ny = N, width = side, height = side, rigidity = 3e-5, group = "sheet " .. k,
    origin = { -side / 2 * (c - s), -side / 2 * (s + c), 0.02 * k }, u = { c, s, 0 }, v = { -s, c, 0 } })
end
scene:force("drag", { rate = 2 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

scene:measure("height of the stack", function(s)
  local sum, ids = 0, top:ids()
  for _, i in ipairs(ids) do sum = sum + s:position(i)[3] end
  return sum / #ids
end, { unit = "m" })
scene:output("frames", { color = "group", thickness = thickness, from = { 0.75, -1.1, 0.55 }, look_at = { 0, 0, 0.04 },
  fov = 26, ground_height = 0 })
return scene
