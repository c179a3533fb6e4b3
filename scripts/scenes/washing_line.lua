-- washing_line.lua: washing hangs in gusts of wind from a line by pegs, rigid bodies that ball joints hold on the line and on the
-- hem, so that they turn with both. A sheet has three pegs. Measures: `sag` of the line's middle, m; `peg`, the largest angle of a peg
-- against the vertical, rad.
local sheets = param("sheets", 2, "on the line", { min = 1, max = 4 })
local N = param("N", 13, "particles along the height of a sheet", { min = 3 })
local speed = param("speed", 3.5, "mean wind, m/s", { min = 0 })
local T = param("duration", 3, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 30, integrator = "leapfrog" }

local width, height, gap, peg, top = 0.6, 0.8, 0.2, 0.06, 1.6 -- m
local length = sheets * (width + gap) + gap
local n = math.floor(length / 0.1 + 0.5) + 1
local line = scene:strand { n = n, from = { 0, 0, top }, to = { length, 0, top }, mass = 0.05 * length }
scene:pin { line:at(1), line:at(n) }

local pegs, structural, shear, flexion = {}, nil, nil, nil
local function join(list, more) return list and list .. more or more end
for k = 1, sheets do
  local left = gap + (k - 1) * (width + gap)
  local M = 2 * ((3 * (N - 1) // 4 + 1) // 2) + 1 -- odd: a particle in the middle of the hem
  local sheet = scene:grid { nx = M, ny = N, width = width, height = height, mass = 0.15 * width * height, u = { 1, 0, 0 },
    v = { 0, 0, 1 }, origin = { left, 0, top - peg - height } }
  for j = 0, 2 do
    local x = left + j * width / 2
    local b = scene:rigid { shape = "box", size = { 0.014, 0.01, peg + 0.02 }, density = 600, position = { x, 0, top - peg / 2 } }
    scene:joint { kind = "ball", a = b, b = line:at(math.floor(x / 0.1 + 0.5) + 1), at = { x, 0, top } }
    scene:joint { kind = "ball", a = b, b = sheet:at(1 + j * (M - 1) // 2, N), at = { x, 0, top - peg } }
    pegs[#pegs + 1] = b
  end
  structural, shear, flexion = join(structural, sheet:structural()), join(shear, sheet:shear()), join(flexion, sheet:flexion())
end
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("springs", { edges = line:structural(), k = 3e4, damping = 0.5, label = "line" })
scene:force("springs", { edges = structural, k = 500, damping = 0.02, label = "structural" })
scene:force("springs", { edges = shear, k = 100, damping = 0.01, label = "shear" })
scene:force("springs", { edges = flexion, k = 5, damping = 0.005, label = "flexion" })
scene:force("wind", { friction = 0.02, velocity = function(t)
  local gust = 1 + 0.4 * math.sin(2.1 * t) + 0.2 * math.sin(5.3 * t)
  return 0.3 * speed * math.sin(1.3 * t), speed * gust * (1 - math.exp(-2 * t)), 0
end })

scene:measure("sag", function(s) return top - s:position(line:at((n + 1) // 2))[3] end, { unit = "m" })
scene:measure("peg", function(s)
  local most = 0
  for _, b in ipairs(pegs) do
    local _, R = b:attitude(s)
    most = math.max(most, math.acos(math.min(1, R[3][3])))
  end
  return most
end, { unit = "rad" })
scene:output("frames", { width = 960, height = 540, color = "none", legend = false, from = { 0.3, -2.1, 1.3 },
  look_at = { length / 2, 0.1, 1.3 }, ground_height = 0.3, tube = 0.004 })
return scene
