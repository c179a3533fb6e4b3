-- peirce.lua: ribbons of cloth held at one end bend under their own weight, the longer the more. Peirce measured the
-- bending rigidity so: where the line from the clamp to the tip falls by 41.5 degrees, the length L has w L^3/EI =
-- 8.0042, w the weight and EI the rigidity per width; the middle ribbon has that length. (Peirce, The handle of cloth
-- as a measurable quantity, J. Textile Institute 21, 1930.) EI of a narrow ribbon is (1 - nu^2) B, and nu of hinges is
-- -1/3.
local N = param("N", 40, "cells along the middle ribbon, which is two cells wide", { min = 4, max = 200 })
local B = param("B", 1e-4, "bending rigidity, N m", { min = 1e-9 })
local density, g, EI = 0.15, 9.81, 8 / 9 * B
local peirce = (8.00420 * EI / (density * g)) ^ (1 / 3)
-- The clamp is in the middle of the first cell: the hinge at its end has a cell's length, too.
local a = peirce / (N - 0.5)

local scene = hooke.scene { duration = 1.5, fps = 60, dt = 1 / 240, integrator = "bdf2" }

local function ribbon(part, place)
  local cells = math.floor(part * N + 0.5)
  local cloth = scene:grid { nx = cells + 1, ny = 3, width = cells * a, height = 2 * a, density = density,
    origin = { -a / 2, place - a, 0 }, alternating = true }
  for j = 1, 3 do scene:pin { cloth:at(1, j), cloth:at(2, j) } end
  scene:force("springs", scene:membrane(cloth, { stiffness = 500, damping = 0.05 }))
  local tip, L = cloth:at(cells + 1, 2), (cells - 0.5) * a
  scene:measure(("angle at w L^3/EI = %.4g"):format(density * g * L ^ 3 / EI), function(s)
    local p = s:position(tip)
    return math.deg(math.atan(-p[3], p[1]))
  end, { unit = "degrees" })
end

for k, part in ipairs { 0.4, 0.7, 1, 1.3, 1.6 } do ribbon(part, 0.022 * k) end
scene:force("hinges", { rigidity = B, damping = 0.02 * B })
scene:force("drag", { rate = 20 })
scene:force("gravity", { g = { 0, 0, -g } })

scene:output("frames", { width = 1280, height = 720, from = { 0.25, -0.07, 0.02 }, look_at = { 0.02, 0.066, -0.042 } })
return scene
