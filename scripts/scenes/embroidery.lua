-- embroidery.lua: a cloth hung by two corners swings down, with a ring, a star and a hem embroidered in thread 1,000
-- times stiffer than its weave, some 3 % of its springs. local_leapfrog takes short steps for the thread alone.
local N = param("N", 96, "particles along one side", { min = 8, max = 2048 })
local k = param("k", 500, "structural stiffness of the cloth, N/m", { min = 0 })
local thread = param("thread", 1000, "stiffness of the thread in that of the cloth", { min = 0 })

local scene = hooke.scene { duration = 1.5, fps = 60, integrator = "local_leapfrog" }

local cloth = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.15 }
scene:pin { cloth:at(1, N), cloth:at(N, N) }

-- Stitches of a ring and a star of five points about the middle, and of a hem along the lower side.
local function stitched(id)
  local i, j = (id - 1) % N, (id - 1) // N
  local x, y = i / (N - 1) - 0.5, j / (N - 1) - 0.5
  local r, angle = math.sqrt(x * x + y * y), math.atan(x, y) % (2 * math.pi / 5) - math.pi / 5
  local width = 0.7 / (N - 1)
  local star = math.abs(r * math.cos(math.abs(angle) - math.pi / 5 * 2) - 0.07) < width and r < 0.23
  return math.abs(r - 0.3) < width or star or j == 1
end

-- The stiffnesses of a list of edges.
local function woven(edges, stiffness)
  local list = {}
  for e, pair in ipairs(edges) do list[e] = stitched(pair[1]) and stitched(pair[2]) and thread * stiffness or stiffness end
  return list
end

scene:force("gravity")
scene:force("drag", { rate = 0.4 })
for _, kind in ipairs { { "structural", 1, 0.02 }, { "shear", 0.3, 0.01 }, { "flexion", 0.05, 0.005 } } do
  local name, part, damping = table.unpack(kind)
  local edges = cloth[name](cloth)
  scene:force("springs", { edges = edges, k = woven(edges, part * k), damping = damping, label = name })
end

scene:output("frames", { width = 1280, height = 960, ground = false })
return scene
