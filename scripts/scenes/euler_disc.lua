-- euler_disc.lua: Euler's disc. A coin leans, its centre rests, and its contact goes round at the rate W of
-- W^2 sin(a) (A - C e sin(a)/(c + e sin(a))) = m g c, where it leans by a, with its moments A and C and a round edge of the radius e on a
-- circle of the radius c (of a thin disc W^2 = 4 g/(c sin(a)), Moffatt 2000, Nature 404, 833). What it loses lets it sink, and go round
-- faster. Its circle is a ring of `n` capsules: `rolling` friction (m) takes energy, and so does each corner that lands, less for more.
-- A step takes half as long as a corner; longer ones lose more, and with 5 ms, hooke's choice, it lies flat after 0.3 s. Measures: `lean`,
-- a, rad; `rate`, how fast the contact goes round in terms of W for this a; `energy of the disc`, J. It lies flat after 1.2 s, where a
-- hundred corners at once are slow.
local n = param("n", 100, "capsules of the edge", { min = 8 })
local start = param("lean", 0.3, "rad", { min = 0.02, max = 1.2 })
local rho = param("rolling", 3e-4, "m", { min = 0 })
local T = param("duration", 1.1, "s", { min = 0.1 })

local fps = 200
local scene = hooke.scene { duration = T, fps = fps, dt = 1 / 2000, integrator = "leapfrog" }

local g, c, edge, mass = 9.81, 0.036, 0.002, 0.14
local A, C = mass * ((c + edge) ^ 2 / 4 + edge ^ 2 / 3), mass * (c + edge) ^ 2 / 2
local function steady(a) return math.sqrt(mass * g * c / (math.sin(a) * (A - C * edge * math.sin(a) / (c + edge * math.sin(a))))) end

-- The spin is along the line from the centre to the contact, so that both rest.
local height = c * math.sin(start) + edge
local w = steady(start) * math.sin(start) / (c + edge * math.sin(start))
local disc = scene:rigid { shape = "cylinder", radius = c + edge, length = 2 * edge, mass = mass, position = { 0, 0, height },
  orientation = { 0, start, 0 }, spin = { -w * c * math.cos(start), 0, w * height } }
local ring = {}
for k = 0, n do
  ring[k + 1] = { c * math.cos(2 * math.pi * k / n), c * math.sin(2 * math.pi * k / n), 0 }
end
disc:surface(ring, { radius = edge, joined = true })
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("obstacle", { shape = "plane", friction = 0.8, rolling = rho })

local function axis(s)
  local _, R = disc:attitude(s)
  return R[1][3], R[2][3], R[3][3]
end
local function lean(s) return math.acos(math.min(1, math.abs(select(3, axis(s))))) end
local last, turn = 0, 0
scene:on_frame(function(s)
  local x, y = axis(s)
  turn, last = (math.atan(y, x) - last + math.pi) % (2 * math.pi) - math.pi, math.atan(y, x)
end)
scene:measure("lean", lean, { unit = "rad" })
scene:measure("rate", function(s) return s.t > 0 and turn * fps / steady(lean(s)) or 1 end)
scene:measure("energy of the disc", function(s) return disc:energy(s) + mass * g * (disc:position(s)[3] - edge) end, { unit = "J" })
scene:output("frames", { width = 960, height = 540, legend = false, from = { 0.1, -0.2, 0.12 }, look_at = { 0, 0, 0.01 } })
return scene
