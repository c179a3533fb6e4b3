-- galaxy.lua: two star clusters, Plummer spheres in equilibrium, fall towards each other on a parabola, pass, are drawn
-- out into tails, and merge. Units: 1,000 parsecs, millions of years, 1e10 suns; "m", "s" and "kg" in reports mean these.
-- The forces are sums by an octree; the summary says how large their errors are.
local N = param("N", 50000, "bodies in both clusters", { min = 2, max = 4000000 })
local alpha = param("alpha", 0.005, "error that a cell of the octree may have, relative to the force", { min = 0 })
local T = param("duration", 600, "millions of years", { min = 1 })
local G, M, a, softening = 0.044985, 10, 5, 0.2 -- a: radius of a cluster

local scene = hooke.scene { duration = T, fps = 1 / 5, integrator = "leapfrog", dt = 0.5 }

local function direction(length)
  local z, angle = 2 * math.random() - 1, 2 * math.pi * math.random()
  local s = math.sqrt(1 - z * z)
  return length * s * math.cos(angle), length * s * math.sin(angle), length * z
end

-- Aarseth, Henon and Wielen 1974: q = v/v_escape has the density q^2 (1 - q^2)^3.5, which is below 0.1.
local function star(center, drift)
  local r
  repeat r = a / math.sqrt(math.random() ^ (-2 / 3) - 1) until r < 10 * a
  local q
  repeat q = math.random() until 0.1 * math.random() < q * q * (1 - q * q) ^ 3.5
  local x, y, z = direction(r)
  local vx, vy, vz = direction(q * math.sqrt(2 * G * M / math.sqrt(r * r + a * a)))
  return { center[1] + x, center[2] + y, center[3] + z }, { drift[1] + vx, drift[2] + vy, drift[3] + vz }
end

-- Two points of mass M on a parabola with this nearest distance: their relative speed is that of escape.
local distance, nearest = 40, 6
local v, across = math.sqrt(4 * G * M / distance), math.sqrt(4 * G * M * nearest) / distance
local along = math.sqrt(v * v - across * across)
local positions, velocities = {}, {}
for i = 1, N // 2 * 2 do
  local side = i <= N // 2 and -1 or 1
  positions[i], velocities[i] =
    star({ side * distance / 2, 0, 0 }, { -side * along / 2, side * across / 2, 0 })
end
local half = #positions // 2
for side = 0, 1 do
  scene:particles { positions = table.move(positions, side * half + 1, (side + 1) * half, 1, {}), group = "cluster " .. side,
    velocities = table.move(velocities, side * half + 1, (side + 1) * half, 1, {}), mass = M / half }
end
scene:force("nbody", { G = G, softening = softening, alpha = alpha })

scene:measure("virial", function(s) return -2 * s:kinetic() / s:potential() end) -- 1 in equilibrium
scene:output("checkpoint", { every = 20 }) -- hooke run --resume goes on from there
scene:output("frames", { width = 1280, height = 720, color = "group", style = "glow", radius = 0.12,
  from = { 0, -20, 95 }, look_at = { 0, 0, 0 }, ground = false, background = { 0, 0, 0.02 }, legend = false })
return scene
