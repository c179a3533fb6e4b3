-- fpu.lua: the chain of Fermi, Pasta and Ulam as in Hairer, Lubich and Wanner: three pairs of beads, stiff springs
-- (w^2/2) inside a pair and soft cubic ones between the pairs and to the walls. The first pair vibrates fast; over some
-- hundred seconds its energy I1 passes to the second and the third pair, while the sum I is nearly constant. At t = 10:
-- I1 = 0.956065119574, I2 = 0.025680529674, I3 = 0.000198333515.
local w = param("w", 50, "frequency of the stiff springs, rad/s", { min = 1 })
local T = param("duration", 20, "s; 200 for the whole exchange", { min = 0.1 })
local gap = 2.5 -- m between neighbours at rest; it has no effect, since the beads slide along a line

local scene = hooke.scene { duration = T, fps = 30, integrator = "blanes_moan", dt = 1e-3 }

local q = { (1 - 1 / w) / math.sqrt(2), (1 + 1 / w) / math.sqrt(2), 0, 0, 0, 0 }
local positions, velocities, beads = {}, {}, {}
for i = 0, 7 do
  positions[i + 1] = { gap * (i - 3.5) + (q[i] or 0), 0, 0 }
  velocities[i + 1] = { i == 2 and math.sqrt(2) or 0, 0, 0 }
  if i > 0 and i < 7 then beads[i] = i + 1 end
end
scene:particles { positions = positions, velocities = velocities, mass = 1 }
scene:pin { 1, 8 }
scene:pin(beads, { axes = { 1, 0, 0 } })

scene:force("springs", { edges = { { 2, 3 }, { 4, 5 }, { 6, 7 } }, k = w ^ 2 / 2, rest = gap, label = "stiff" })
scene:force("cubic_springs", { edges = { { 1, 2 }, { 3, 4 }, { 5, 6 }, { 7, 8 } }, k = 4, rest = gap, label = "soft" })

local function energy(s, j) -- energy of the vibration inside pair j
  local a, b = 2 * j, 2 * j + 1
  local x = (s:position(b)[1] - s:position(a)[1] - gap) / math.sqrt(2)
  local y = (s:velocity(b)[1] - s:velocity(a)[1]) / math.sqrt(2)
  return (y ^ 2 + (w * x) ^ 2) / 2
end
for j = 1, 3 do scene:measure("I" .. j, function(s) return energy(s, j) end) end
scene:measure("I", function(s) return energy(s, 1) + energy(s, 2) + energy(s, 3) end)
scene:measure("H", function(s) return s:energy() end) -- 2.00120008 for w = 50

scene:output("frames", { width = 1280, height = 400, color = "speed", range = { 0, 2 }, radius = 0.45,
  from = { 0, -22, 6 }, look_at = { 0, 0, -0.3 }, fov = 17, ground_height = -1.1 })
return scene
