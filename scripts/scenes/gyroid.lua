-- gyroid.lua: a plate of a gyroid, the sheet sin x cos y + sin y cos z + sin z cos x = 0 made thick, of tetrahedra,
-- is pressed to three quarters of its height and let go: it bulges, and springs back.
local size = param("size", 0.08, "of a cell, m", { min = 0.02, max = 0.1 })
local E = param("E", 1e5, "Young's modulus, Pa", { min = 1000 })

local scene = hooke.scene { duration = 1, fps = 60, integrator = "leapfrog" }
local waves, half, height = 2 * math.pi, 0.5, 0.25

local function sheet(x, y, z)
  local a, b, c = waves * x, waves * y, waves * z
  return math.sin(a) * math.cos(b) + math.sin(b) * math.cos(c) + math.sin(c) * math.cos(a)
end
local function slab(x, y, z) return math.min(half - math.max(math.abs(x), math.abs(y)), height - math.abs(z)) end

local plate = scene:implicit { as = "solid", size = size, density = 1000,
  box = { { -0.7, -0.7, -0.45 }, { 0.7, 0.7, 0.45 } },
  intersection = { { f = function(x, y, z) return 0.6 - math.abs(sheet(x, y, z)) end }, { f = slab } } }
scene:force("neo_hookean", { tetrahedra = plate:tetrahedra(), E = E, nu = 0.4, damping = 0.002 * E })

local press, pressed = 0.12, 0.5 -- m; s, until it is let go
local top = scene:within({ -1, -1, height - 0.6 * size }, { 1, 1, 1 })
scene:pin(scene:within({ -1, -1, -1 }, { 1, 1, -height + 0.6 * size }))
scene:pin(top, { release = pressed, path = function(t) return 0, 0, -press * math.min(t / pressed, 1) end })

scene:measure("height of the top", function(s)
  local sum = 0
  for _, i in ipairs(top) do sum = sum + s:position(i)[3] / #top end
  return sum + height
end, { unit = "m" })
scene:output("frames", { color = "none", springs = "off", particles = "off", from = { 1.7, -2.4, 1.4 },
  look_at = { 0, 0, -0.05 }, fov = 26, ground_height = -height })
return scene
