-- cantilever.lua: four rods in a wall, of one weight and of stiffnesses that differ by 1 : 4 : 20 : 100, are let go and
-- come to rest as the elastica, which the dark dots mark: w L^3/EI is 0.2, 1, 5 and 20. Their tips then hang 0.0249875,
-- 0.1234714, 0.4959050 and 0.8298814 m below the wall; with n segments they are off by a multiple of 1/n^2.
local numerics = require("numerics")

local n = param("n", 40, "segments", { min = 2 })
local T = param("duration", 5, "s", { min = 0.1 })

local length, radius, density, g = 1, 4e-3, 1000, 9.81 -- m, m, kg/m^3, m/s^2
local w = density * math.pi * radius ^ 2 * g           -- N/m
local scene = hooke.scene { duration = T, fps = 60, dt = 1 / 240, integrator = "bdf2" }

-- The tangent falls by a(s): EI a'' = -w (L - s) cos a, a(0) = 0, a'(L) = 0. Returns the points at s = 0, 1/24, ..., 1.
local function elastica(ratio)
  local function slope(s, y)
    return { y[2], -ratio * (1 - s) * math.cos(y[1]), math.cos(y[1]), -math.sin(y[1]) }
  end
  local start = numerics.root(function(bend) return numerics.ode(slope, 0, { 0, bend, 0, 0 }, 1)[2] end, 0, 1 + ratio / 2)
  local points, y = {}, { 0, start, 0, 0 }
  for k = 1, 24 do
    y = numerics.ode(slope, (k - 1) / 24, y, k / 24)
    points[k] = y
  end
  return points
end

for k, ratio in ipairs { 0.2, 1, 5, 20 } do
  local y = 0.03 * k
  local EI = w * length ^ 3 / ratio
  local rod = scene:strand { n = n + 2, from = { 0, y, 0 }, direction = { 1, 0, 0 }, length = length, clamped = true,
    radius = radius, density = density, E = 4 * EI / (math.pi * radius ^ 4), group = "rods" }
  scene:force("springs", { edges = rod:edges(), k = rod.stiffness, label = "stretch" .. k })
  scene:force("angle_springs", { edges = rod:edges(), EI = rod.EI, label = "bend" .. k })
  local exact = elastica(ratio)
  for _, p in ipairs(exact) do
    scene:pin { scene:particle { position = { p[3], y, p[4] }, mass = 1, group = "elastica" } }
  end
  scene:measure(("w L^3/EI = %g: drop"):format(ratio), function(s) return -s:position(rod:at(n + 2))[3] end, { unit = "m" })
  scene:measure(("w L^3/EI = %g: off"):format(ratio), function(s)
    return math.abs(s:position(rod:at(n + 2))[3] - exact[24][4])
  end, { unit = "m" })
end
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("drag", { rate = 4 })
scene:output("frames", { width = 1280, height = 720, color = "group", from = { 0.5, -2.1, -0.25 },
  look_at = { 0.5, 0, -0.4 }, radius = 0.007, ground = false })
return scene
