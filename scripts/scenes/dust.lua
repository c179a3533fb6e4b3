-- dust.lua: a curtain of striped dust in a gusty wind is rolled up by a whirl and frayed by turbulence. The dust follows
-- the air closely, so what one sees is the air: the whirl's core turns like a solid body, around it the stripes are wound
-- into ever thinner layers, and gusts shake all of it. One force has the whole drag, F = rate m (u - v); the others add
-- their air to it, relative = false. The steps resolve gusts and eddies: both say how fast they change.
local N = param("N", 200, "particles along the height", { min = 2, max = 1000 })
local speed = param("speed", 0.3, "mean wind, m/s")
local rate = param("rate", 200, "1/s: how closely the dust follows the air; it settles at g/rate", { min = 1 })

local scene = hooke.scene { duration = 3, fps = 30 }

local width, height, M = 4.8, 2.4, 2 * N
local red, blue, white = { 0.80, 0.22, 0.12 }, { 0.10, 0.30, 0.55 }, { 0.96, 0.90, 0.78 }
scene:channel("dye", { size = 3 })
for j = 1, N do
  local z = height * (j - 0.5) / N
  local band = math.floor(12 * z / height)
  local dye = band % 2 == 0 and white or band % 4 == 1 and red or blue
  for i = 1, M do
    scene:particle { position = { width * ((i - 0.5) / M - 0.5), 0, z }, mass = 1e-9, dye = dye }
  end
end

local gust = hooke.gust { mean = { speed, 0, 0 }, amplitude = { 0.25, 0.1, 0.1 }, shortest = 0.4, seed = 4 }
scene:force("gravity")
scene:force("wind", { on = "particles", rate = rate, velocity = gust })
scene:force("vortex", { strength = -5, core = 0.4, axis = { 0, 1, 0 }, rate = rate, relative = false,
  center = function(t) return -0.3 + speed * t, 0, 1.2 end })
scene:force("turbulence", { speed = 0.15, largest = 1.6, smallest = 0.25, drift = { speed, 0, 0 }, rate = rate,
  relative = false, seed = 3 })

local middle = (N // 2) * M + M // 2
scene:measure("middle", function(s) return s:position(middle)[1] end, { unit = "m" })
scene:output("frames", { width = 1280, height = 720, color = "dye", radius = 0.006, ground_height = -0.9,
  from = { 0.25, -9, 2 }, look_at = { 0.5, 0, 1.2 } })
return scene
