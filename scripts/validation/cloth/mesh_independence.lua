-- A sheet held along its border sags under its weight: by the numbers of its material as far on squares with both
-- diagonals as on a mesh of alternating ones. (With one spring constant for all edges and equal masses the two differ
-- by a tenth at any n: hooke sweep scripts/sweeps/discretization.lua.)
local validation = require("validation")
local sheet = require("sheet")

local density, Y, g = 0.15, 20, 9.81

local function sag(n, squares)
  local scene = hooke.scene { duration = 20, fps = 4, dt = 0.01, integrator = "backward_euler" }
  local shape = sheet.alternating(n)
  local cloth
  if squares then
    cloth = scene:grid { nx = n + 1, ny = n + 1, density = density }
  else
    cloth = scene:mesh { vertices = shape.vertices, faces = shape.faces, density = density }
  end
  local border, ids = {}, cloth:ids()
  for k, p in ipairs(shape.vertices) do
    if math.min(p[1], p[2], 1 - p[1], 1 - p[2]) < 1e-9 then border[#border + 1] = ids[k] end
  end
  scene:pin(border)
  scene:force("springs", scene:membrane(cloth, { stiffness = Y }))
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:force("drag", { rate = 12 })
  local s = validation.rest(scene, 0.5, 1e-9, 20):state()
  return -s:position(ids[n // 2 * (n + 1) + n // 2 + 1])[3]
end

return validation.problem {
  title = "Sag of a sheet, on two meshes",
  quantities = {
    { name = "alternating/squares", unit = "", reference = 1, source = "the same material" },
  },
  space = { 12, 24, 48 },
  order = { space = 2, within = 0.5 }, -- errors of order 2 and, with some tens, of order 4 have opposite signs
  tolerance = 1e-4,
  why = "2e-4 at n = 48; the orders have not parted there",
  noise = 1e-8,
  forces = { springs = { "edges", "k" } },
  quick = { space = { 4, 6, 8 }, tolerance = 0.02 },
  solve = function(at) return sag(at.n, false) / sag(at.n, true) end,
}
