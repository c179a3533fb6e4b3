-- discretization.lua: one sheet, held along its border, falls from flat, swings and comes to rest, as N x N squares,
-- with alternating diagonals, or as an irregular mesh. With numbers of the material (numbers=material) sag and first
-- period of its middle come out the same for any N and mesh; with one spring constant and equal masses (numbers=raw)
-- they do not.   hooke sweep scripts/sweeps/discretization.lua
local sheet = require("sheet")
local N = param("N", 32, "cells along one side", { min = 4, max = 256 })
local mesh = param("mesh", "irregular", "regular, alternating or irregular")
local numbers = param("numbers", "material", "material or raw")
local density, Y, B = 0.15, 20, 1e-5 -- kg/m^2, N/m, N m

local scene = hooke.scene { duration = 1.6, fps = 100, integrator = "leapfrog" }

local shape = assert(sheet[mesh], "mesh: regular, alternating or irregular")(N)
local raw = numbers == "raw"
local cloth
if mesh == "regular" then
  cloth = scene:grid { nx = N + 1, ny = N + 1, mass = raw and density or nil, density = not raw and density or nil }
else
  cloth = scene:mesh { vertices = shape.vertices, faces = shape.faces, mass = raw and density or nil,
    density = not raw and density or nil }
end
local ids, border, middle, nearest = cloth:ids(), {}, 1, math.huge
for k, p in ipairs(shape.vertices) do
  if math.min(p[1], p[2], 1 - p[1], 1 - p[2]) < 1e-9 then border[#border + 1] = ids[k] end
  local away = (p[1] - 0.5) ^ 2 + (p[2] - 0.5) ^ 2
  if away < nearest then middle, nearest = ids[k], away end
end
scene:pin(border)

if raw then
  local edges = mesh == "regular" and cloth:structural() .. cloth:shear() or cloth:edges()
  scene:force("springs", { edges = edges, k = 0.75 * Y, label = "membrane" })
else
  local springs = scene:membrane(cloth, { stiffness = Y })
  springs.label = "membrane"
  scene:force("springs", springs)
end
scene:force("hinges", { rigidity = B })
scene:force("gravity")
scene:force("drag", { rate = 30, from = 0.6 }) -- after the first swing it comes to rest

local before, period = {}, 0
scene:on_frame(function(s) -- when the whole is highest again for the first time, by a parabola through three frames
  if period > 0 then return end
  local z, a, b = 0, before[1], before[2]
  for _, id in ipairs(ids) do z = z + s:mass(id) * s:position(id)[3] end
  if a and s.t > 0.05 and b > a and b >= z then period = s.t - 0.01 - 0.005 * (z - a) / (z - 2 * b + a) end
  before = { b, z }
end)
scene:measure("sag", function(s) return -s:position(middle)[3] end, { unit = "m" })
scene:measure("period", function() return period end, { unit = "s" })

scene:output("frames", { width = 1280, height = 720, from = { 1.7, -0.9, 0.7 }, look_at = { 0.5, 0.5, -0.05 } })
return scene
