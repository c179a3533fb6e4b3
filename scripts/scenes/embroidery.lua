-- embroidery.lua: a hanging cloth whose upper corners are drawn together. Where a ring and a star are embroidered, in
-- thread 1,000 times stiffer than the weave, it is not strained. local_leapfrog takes short steps for the thread alone.
local N = param("N", 96, "particles along one side", { min = 8, max = 2048 })
local k = param("k", 60, "structural stiffness of the cloth, N/m", { min = 0 })
local thread = param("thread", 1000, "stiffness of the thread in that of the cloth", { min = 0 })

local scene = hooke.scene { duration = 1.5, fps = 60, integrator = "local_leapfrog" }

local cloth = scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.15, u = { 1, 0, 0 }, v = { 0, 0, 1 } }
for side = 1, 2 do
  local way = side == 1 and 0.12 or -0.12
  scene:pin({ cloth:at(side == 1 and 1 or N, N) }, { path = function(t)
    local s = math.min(t, 1)
    return way * s * s * (3 - 2 * s), 0, 0
  end })
end

-- Whether a particle lies on the ring or on the star of five points, about the middle.
local function stitched(id)
  local i, j = (id - 1) % N, (id - 1) // N
  local x, y = i / (N - 1) - 0.5, j / (N - 1) - 0.5
  local r, angle = math.sqrt(x * x + y * y), math.atan(x, y) % (2 * math.pi / 5) - math.pi / 5
  local width = 0.012
  local star = math.abs(r * math.cos(math.abs(angle) - math.pi / 5 * 2) - 0.07) < width and r < 0.23
  return math.abs(r - 0.3) < width or star
end

-- The stiffnesses of a list of edges.
local function woven(edges, stiffness)
  local list = {}
  for e, pair in ipairs(edges) do list[e] = stitched(pair[1]) and stitched(pair[2]) and thread * stiffness or stiffness end
  return list
end

scene:force("gravity")
scene:force("drag", { rate = 1 })
scene:force("wind", { velocity = { 0, 1.5, 0 } })
for _, kind in ipairs { { "structural", 1, 0.01 }, { "shear", 0.3, 0.005 }, { "flexion", 0.05, 0.002 } } do
  local name, part, damping = table.unpack(kind)
  local edges = cloth[name](cloth)
  scene:force("springs", { edges = edges, k = woven(edges, part * k), damping = damping, label = name })
end

scene:output("frames", { width = 1280, height = 960, range = { -0.04, 0.04 }, from = { 0.9, -2.1, 0.75 }, look_at = { 0.5, 0, 0.48 } })
return scene
