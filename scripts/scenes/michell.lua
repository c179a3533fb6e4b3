-- michell.lua: a straight rod is bent into a ring and its ends, joined, are turned against each other. The ring stays
-- flat up to 2 pi sqrt(3)/ratio, 10.88 rad where twist and bending are equally stiff (Michell 1889), then buckles out
-- of its plane and folds into a figure of eight, with nothing to stop it where it meets itself.
local n = param("n", 100, "edges of the ring", { min = 8 })
local ratio = param("ratio", 1, "stiffness in twist over that of bending, GJ/EI", { min = 0.1 })
local most = param("most", 14, "angle to which the ends are turned, rad")
local rate = param("rate", 1, "speed of turning, rad/s", { min = 1e-3 })
local EI, density, axial = 1, 1, 2000 -- N m^2, kg/m, N; of a ring of radius 1 m

local scene = hooke.scene { duration = 2 + most / rate + 16, fps = 30, integrator = "leapfrog" }

local length = 2 * math.pi / n
local positions, masses, edges = {}, {}, {}
for i = 1, n do
  local angle = 2 * math.pi * i / n -- a little out of the plane, or nothing would choose a side
  positions[i] = { math.cos(angle), math.sin(angle), 0.02 * math.cos(2 * angle) }
  masses[i], edges[i] = density * length, { i, i % n + 1 }
end
local ring = scene:particles { positions = positions, masses = masses }

local function turn(t) return math.max(0, math.min(most, rate * (t - 2))) end
scene:force("springs", { edges = edges, k = axial / length })
scene:force("rods", { edges = edges, EI = EI, GJ = ratio * EI, rest = "straight", turn = turn })
scene:force("drag", { rate = 0.3 })

scene:measure("turn", function(s) return turn(s.t) end, { unit = "rad" })
scene:measure("out of plane", function(s)
  local low, high = math.huge, -math.huge
  for _, id in ipairs(ring:ids()) do
    local z = s:position(id)[3]
    low, high = math.min(low, z), math.max(high, z)
  end
  return high - low
end, { unit = "m" })
scene:output("frames", { width = 960, height = 720, radius = 0.04, color = "none", from = { 1.8, -4.6, 2.2 }, look_at = { 0, 0, 0 },
  fov = 21, ground_height = -1.5 })
return scene
