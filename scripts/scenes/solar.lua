-- solar.lua: the sun and the outer planets for 200,000 days, 550 years (Hairer, Lubich and Wanner, Geometric Numerical
-- Integration, I.2.4, by data of the year 1994). Dots mark the ellipses on which they begin, as if each were alone with
-- the sun. Units: the earth's distance, days, masses of the sun; "m", "s" and "kg" in reports mean these. Leapfrog with
-- dt = 200, 20 steps to an orbit of Jupiter, keeps to the orbits as well, though not to the places on them; explicit
-- Euler spirals out: try --integrator euler --dt 10.
local T = param("duration", 200000, "days", { min = 1 })
local G = 2.95912208286e-4
local bodies = {
  { "sun", 1.00000597682, { 0, 0, 0 }, { 0, 0, 0 } },
  { "jupiter", 0.000954786104043, { -3.5023653, -3.8169847, -1.5507963 }, { 0.00565429, -0.00412490, -0.00190589 } },
  { "saturn", 0.000285583733151, { 9.0755314, -3.0458353, -1.6483708 }, { 0.00168318, 0.00483525, 0.00192462 } },
  { "uranus", 0.0000437273164546, { 8.3101420, -16.2901086, -7.2521278 }, { 0.00354178, 0.00137102, 0.00055029 } },
  { "neptune", 0.0000517759138449, { 11.4707666, -25.7294829, -10.8169456 }, { 0.00288930, 0.00114527, 0.00039677 } },
  { "pluto", 1 / 1.3e8, { -15.5387357, -25.2225594, -3.1902382 }, { 0.00276725, -0.00170702, -0.00136504 } },
}

local scene = hooke.scene { duration = T, fps = 1 / 200, integrator = "blanes_moan", dt = 50 }

local ids = {}
for k, b in ipairs(bodies) do
  ids[k] = scene:particle { position = b[3], velocity = b[4], mass = b[2], group = b[1] }
  scene:measure(b[1], function(s) -- its distance from the sun
    local x, sun = s:position(ids[k]), s:position(ids[1])
    return math.sqrt((x[1] - sun[1]) ^ 2 + (x[2] - sun[2]) ^ 2 + (x[3] - sun[3]) ^ 2)
  end)
end
scene:force("nbody", { G = G, only = ids })

local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end
local function sum(p, a, q, b) return { p * a[1] + q * b[1], p * a[2] + q * b[2], p * a[3] + q * b[3] } end

-- The ellipse through x with the velocity v: centre, half axes.
for k = 2, #bodies do
  local x, v, mu, dots = bodies[k][3], bodies[k][4], G * (bodies[1][2] + bodies[k][2]), {}
  local r = math.sqrt(dot(x, x))
  local a, e = 1 / (2 / r - dot(v, v) / mu), sum(dot(v, v) / mu - 1 / r, x, -dot(x, v) / mu, v)
  local size = math.sqrt(dot(e, e))
  local along = sum(1 / size, e, 0, e)
  local across = dot(x, along) * dot(v, along) > 0 and sum(dot(v, along), x, -dot(x, along), v)
    or sum(-dot(v, along), x, dot(x, along), v) -- in the plane of the orbit, and across its axis
  local half = a * math.sqrt(1 - size * size) / math.sqrt(dot(across, across))
  for n = 1, 120 do
    local angle = 2 * math.pi * n / 120
    dots[n] = sum(a * (math.cos(angle) - size), along, half * math.sin(angle), across)
  end
  scene:pin(scene:particles { positions = dots, mass = 1, group = bodies[k][1] })
end

scene:measure("energy", function(s) return s:energy() end) -- -3.2154531832081635e-8
scene:output("frames", { width = 1280, height = 720, color = "group", radius = 0.55, every = 4,
  from = { 0, -62, 108 }, look_at = { 2, 3, 0 }, ground = false, background = { 0.03, 0.04, 0.08 }, legend = false })
return scene
