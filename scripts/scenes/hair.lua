-- hair.lua: two tufts on spheres, straight hair and curls, hang down and blow in a gust. Hair bends and twists as a
-- strand of radius 0.04 mm and E = 4 GPa does; it stretches 3000 times as easily as that, which is still below 1 %, and
-- lets an implicit method take one step a frame. The strands hang together by nothing, so the matrix of a step falls
-- into one narrow band a strand, which `banded` factorizes in a time that grows with their number alone. Nothing keeps
-- hair out of the spheres. strands=400 makes better pictures.
local S = param("strands", 30, "of each tuft", { min = 1, max = 100000 })
local n = param("segments", 32, "of a strand", { min = 2, max = 1000 })
local soft = param("soft", 3000, "by how much EA is divided", { min = 1 })
local speed = param("speed", 1.5, "of the gust, m/s", { min = 0 })

local scene = hooke.scene { duration = 3, fps = 60, dt = 1 / 60 }
scene:integrator("bdf2", { tolerance = 1e-2, reuse = false })

local function tuft(name, x, curl)
  local hair = scene:hair { on = { centre = { x, 0, 0 }, radius = 0.09, cap = 1.3 }, strands = S, n = n + 1, length = 0.3,
    spread = 0.05, seed = 1, curl = curl, radius = 4e-5, E = 4e9, nu = 0.4, density = 1300, group = name }
  local k = hair.stiffness
  if type(k) == "table" then for i = 1, #k do k[i] = k[i] / soft end else k = k / soft end
  scene:force("springs", { edges = hair:edges(), k = k, label = "stretch of " .. name })
  if curl then scene:force("rods", { edges = hair:edges(), EI = hair.EI, GJ = hair.GJ, label = "bending of " .. name })
  else scene:force("angle_springs", { edges = hair:edges(), EI = hair.EI, label = "bending of " .. name }) end
  scene:measure("stretch of " .. name, function(s) return s:strain("stretch of " .. name) end)
end

tuft("straight", -0.25)
tuft("curly", 0.25, { radius = 0.01, pitch = 0.06 })
-- Linear drag in air that moves with u(t), -rate m (v - u): drag, and an acceleration that is the same everywhere.
local rate = 8 -- 1/s
scene:force("drag", { rate = rate })
scene:force("gravity", { g = function(t)
  local gust = rate * speed * math.max(0, math.sin(math.pi * (t - 1)))
  return gust, 0.4 * gust * math.sin(7 * t), -9.81
end })
scene:output("frames", { width = 1280, height = 720, color = "group", from = { 0, -1.25, 0.1 }, look_at = { 0, 0, -0.1 },
  particles = "off", spheres = { -0.25, 0, 0, 0.09, 0.25, 0, 0, 0.09 }, ground = false })
return scene
