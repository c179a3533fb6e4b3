-- truss.lua: a bridge of rigid bars, pinned at its left end and on a roller at its right, with a weight on a spring below
-- its middle, which has just fallen 0.1 m and bounces. The bars cannot give: each carries at every moment what the method
-- of joints says of the spring's pull. A weight put on suddenly pulls with up to twice its weight, one that fell h with
-- 1 + sqrt(1 + 2 h k/(m g)) times that. Tension is positive: the lower chord is pulled, the upper one pressed.
local panels = param("panels", 6, "triangles that stand on the lower chord, an even number", { min = 2 })
local fall = param("fall", 0.1, "of the weight before the start, m", { min = 0 })
local T = param("duration", 2, "s", { min = 0.1 })

local a, g, k, m, length = 1, 9.81, 4000, 20, 0.6 -- m, m/s^2, N/m, kg, m
local scene = hooke.scene { duration = T, fps = 60, integrator = "leapfrog", dt = 1 / 2400 }
local lower, upper, edges, number, flat = {}, {}, {}, {}, { normal = { 0, 1, 0 } }
local function bar(name, i, j)
  edges[#edges + 1] = { i, j }
  number[name] = #edges
end
for p = 0, panels do
  lower[p] = scene:particle { position = { p * a, 0, 0 }, mass = 1, group = "bridge" }
  if p > 0 then
    upper[p] = scene:particle { position = { (p - 0.5) * a, 0, a * math.sqrt(3) / 2 }, mass = 1, group = "bridge" }
    bar("lower " .. p, lower[p - 1], lower[p])
    bar("rising " .. p, lower[p - 1], upper[p])
    bar("falling " .. p, upper[p], lower[p])
    scene:pin({ upper[p] }, flat)
  end
  if p > 1 then bar("upper " .. p - 1, upper[p - 1], upper[p]) end
  if p > 0 and p < panels then scene:pin({ lower[p] }, flat) end
end
scene:pin { lower[0] }
scene:pin({ lower[panels] }, { axes = { 1, 0, 0 } })

local middle = panels // 2
local weight = scene:particle { position = { middle * a, 0, -length }, velocity = { 0, 0, -math.sqrt(2 * g * fall) },
  mass = m, group = "weight" }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = { { lower[middle], weight } }, k = k })
scene:constraint("bars", { edges = edges })

local largest = 0
scene:measure("pull", function(s) return s:force("springs", weight)[3] end, { unit = "N" })
scene:measure("largest pull, weights", function(s)
  largest = math.max(largest, s:force("springs", weight)[3] / (m * g))
  return largest
end)
for _, name in ipairs { "lower " .. middle, "upper " .. middle, "rising 1", "rising " .. middle } do
  scene:measure(name, function(s) return s:constraint_forces("bars")[number[name]] end, { unit = "N" })
end
scene:output("frames", { width = 1280, height = 640, color = "group", size = "mass", radius = 0.11,
  from = { 3, -7, 0.6 }, look_at = { 3, 0, 0 }, ground_height = -1.3 })
return scene
