-- granular_gas.lua: discs that lose energy when they meet, in a box that repeats, without a weight. The gas cools by Haff's
-- law, T = T0/(1 + t/tau)^2, as long as it is even (Haff, J. Fluid Mech. 134, 1983), and gathers into clusters, where discs
-- meet more often and cool faster (Goldhirsch and Zanetti, Phys. Rev. Lett. 70, 1993). restitution=1: it stays even, and warm.
local n = param("n", 2500, "discs", { min = 16, max = 1e6 })
local restitution = param("restitution", 0.7, "speed after a head-on collision, as a part of that before", { min = 0, max = 1 })
local k = param("stiffness", 500, "of a disc, N/m: 1e4 are hard, as Haff's are; 500 overlap by R/10 at first", { min = 1 })
local R, filled, m = 0.01, 0.25, 1e-3 -- m; part of the area; kg

local scene = hooke.scene { duration = 20, fps = 10, integrator = "leapfrog" }
local across = math.ceil(math.sqrt(n))
local gap = math.sqrt(n * math.pi * R ^ 2 / filled) / across -- of a square lattice, shaken, which is soon forgotten
scene:periodic { high = { across * gap, across * gap, 1 }, axes = "xy" }

local function normal() return math.sqrt(-2 * math.log(1 - math.random())) * math.cos(2 * math.pi * math.random()) end
local v, mean, square = {}, { 0, 0 }, 0
for i = 1, n do
  v[i] = { normal(), normal(), 0 }
  for c = 1, 2 do mean[c] = mean[c] + v[i][c] / n end
end
for i = 1, n do
  for c = 1, 2 do v[i][c] = v[i][c] - mean[c] end
  square = square + (v[i][1] ^ 2 + v[i][2] ^ 2) / (2 * n)
end
for i = 0, n - 1 do
  local speed = v[i + 1]
  for c = 1, 2 do speed[c] = speed[c] / math.sqrt(square) end -- T0/m = 1 m^2/s^2
  local function place(at) return gap * (at + 0.5) + 0.1 * R * (math.random() - 0.5) end
  scene:particle { position = { place(i % across), place(i // across), 0 }, velocity = speed, mass = m }
end
scene:service("neighbours", { skin = 0.5 })
scene:force("soft_spheres", { radius = R, stiffness = k, restitution = restitution, friction = 0 })

-- By Enskog's rate of collisions of a disc, w = 2 sqrt(pi) x n d sqrt(T/m), each of which takes (1 - e^2)/2 of T in two
-- dimensions, with the pair correlation at contact x = (1 - 7/16 f)/(1 - f)^2 of discs that fill f (Henderson 1975).
local x = (1 - 7 / 16 * filled) / (1 - filled) ^ 2
local rate = 2 * math.sqrt(math.pi) * x * filled / (math.pi * R ^ 2) * 2 * R
local tau = 4 / ((1 - restitution ^ 2) * rate)

local function temperature(s) -- by T0
  local sum = 0
  for _, id in ipairs(s:ids()) do
    local u = s:velocity(id)
    sum = sum + (u[1] ^ 2 + u[2] ^ 2) / 2
  end
  return sum / n
end

-- Once the lattice is forgotten, T^(-1/2) grows by 1/tau a second: how fast it has grown since frame 1, by that.
local first
local function haff(s)
  local now = { s.t, 1 / math.sqrt(temperature(s)) }
  first = first or s.t > 0 and now or nil
  return first and now[1] > first[1] and (now[2] - first[2]) / (now[1] - first[1]) * tau or 1
end
scene:measure("temperature", temperature)
scene:measure("haff", haff)
local side = across * gap
scene:output("frames", { radius = R, color = "speed", log = true, from = { side / 2, side / 2, 2.4 * side },
  look_at = { side / 2, side / 2, 0 }, ground = false, every = 10 })
return scene
