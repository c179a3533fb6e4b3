-- solar.lua: the sun and the outer planets for 200,000 days, 550 years (Hairer, Lubich and Wanner, Geometric Numerical
-- Integration, I.2.4, by data of the year 1994). Units: the sun's distance, days, masses of the sun with its inner planets; "m", "s"
-- and "kg" in reports mean these. Leapfrog with dt = 200, 20 steps to an orbit of Jupiter, keeps to the orbits as well,
-- though not to the places on them; explicit Euler spirals out: try --integrator euler --dt 10.
local T = param("duration", 200000, "days", { min = 1 })
local bodies = {
  { "sun", 1.00000597682, { 0, 0, 0 }, { 0, 0, 0 } },
  { "jupiter", 0.000954786104043, { -3.5023653, -3.8169847, -1.5507963 }, { 0.00565429, -0.00412490, -0.00190589 } },
  { "saturn", 0.000285583733151, { 9.0755314, -3.0458353, -1.6483708 }, { 0.00168318, 0.00483525, 0.00192462 } },
  { "uranus", 0.0000437273164546, { 8.3101420, -16.2901086, -7.2521278 }, { 0.00354178, 0.00137102, 0.00055029 } },
  { "neptune", 0.0000517759138449, { 11.4707666, -25.7294829, -10.8169456 }, { 0.00288930, 0.00114527, 0.00039677 } },
  { "pluto", 1 / 1.3e8, { -15.5387357, -25.2225594, -3.1902382 }, { 0.00276725, -0.00170702, -0.00136504 } },
}

local scene = hooke.scene { duration = T, fps = 1 / 200, integrator = "blanes_moan", dt = 50 }

for _, b in ipairs(bodies) do
  local id = scene:particle { position = b[3], velocity = b[4], mass = b[2], group = b[1] }
  scene:measure(b[1], function(s) -- its distance from the sun
    local x, sun = s:position(id), s:position(1)
    return math.sqrt((x[1] - sun[1]) ^ 2 + (x[2] - sun[2]) ^ 2 + (x[3] - sun[3]) ^ 2)
  end)
end
scene:force("nbody", { G = 2.95912208286e-4 })

scene:measure("energy", function(s) return s:energy() end) -- -3.2154531832081635e-8
scene:output("frames", { width = 1280, height = 720, color = "group", radius = 0.8, every = 4, particles = "on",
  camera = { 0, -75, 42 }, target = { 0, 0, -3 }, ground = false, background = { 0.02, 0.02, 0.05 } })
return scene
