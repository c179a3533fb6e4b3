-- stiff_string.lua: a slack string between two hooks, plucked aside at a third, falls back, swings and comes to rest in
-- the elastic catenary. k (1e2 to 1e8 N/m) hardly changes the motion, but an explicit step shrinks with 1/sqrt(k). At
-- rest with k = 2500 (EA = 100 N): sag 0.297930 m, pull on a hook 0.755906 N; inextensible: 0.292344 and 0.761885.
local k = param("k", 1e6, "stiffness of one spring, N/m", { min = 1 })
local n = param("n", 31, "particles in the string, a multiple of 3 and 1", { min = 4 })
local rate = param("drag", 1.5, "drag rate, 1/s", { min = 0 })

local scene = hooke.scene { duration = 6, fps = 60, integrator = "bdf2" }

-- 1.2 m of string that weighs 1 N per metre; the hooks are 1 m apart and the pluck is 0.4 m along it.
local g, L, l = 9.81, 1.2, 1.2 / (n - 1)
local mass = L / g / (n - 1)
local height = math.sqrt(0.4 ^ 2 - 0.26 ^ 2)
local corner = { 0.26, -0.8 * height, 0.6 * height }
local positions, edges = {}, {}
for i = 0, n - 1 do
  local s = i * l
  local a = s <= 0.4 and s / 0.4 or (L - s) / 0.8 -- 0 at the hooks, 1 at the corner
  local from = s <= 0.4 and 0 or 1
  positions[i + 1] = { from + (corner[1] - from) * a, corner[2] * a, corner[3] * a }
  if i > 0 then edges[i] = { i, i + 1 } end
end
local string = scene:particles { positions = positions, mass = mass }
scene:pin { string:at(1), string:at(n) }

scene:force("gravity", { g = { 0, 0, -g } })
scene:force("drag", { rate = rate })
scene:force("springs", { edges = edges, k = k, damping = 2e-3 * math.sqrt(k * mass), rest = l, label = "string" })

scene:measure("sag", function(s)
  local z = 0
  for i = 1, n do z = math.min(z, s:position(string:at(i))[3]) end
  return -z
end, { unit = "m" })
scene:measure("pull", function(s) -- force on the hook at the origin, with half the weight of its particle
  local f = s:force("string", string:at(1))
  return math.sqrt(f[1] ^ 2 + f[2] ^ 2 + (f[3] - mass * g / 2) ^ 2)
end, { unit = "N" })
scene:measure("stretch", function(s) return s:strain("string") end)
scene:output("frames", { width = 1280, height = 720, color = "speed", radius = 0.012, particles = "on",
  from = { 0.1, -1.6, 0.4 }, look_at = { 0.5, 0, -0.08 }, ground_height = -0.42 })
return scene
