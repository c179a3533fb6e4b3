-- A membrane of triangles hangs from its upper border, and its own weight stretches it: with nu = 0 every thread by
-- itself, by rho g L^2/(2 Y) at the end. The warp is across. Masses are thirds of the triangles around a corner, which
-- on alternating and irregular meshes differ from corner to corner.
local validation = require("validation")
local triangles = require("_triangles")

local density, g, Y = 0.2, 10, 16
local stretch = density * g / (2 * Y)
local source = "closed form, rho g L^2/(2 Y), L = 1 m"

local function hang(kind, n)
  local scene = hooke.scene { duration = 60, fps = 2, dt = 0.05, integrator = "backward_euler" }
  local ids, corners, faces, uv = triangles.add(scene, kind, n, function(x, y) return x, 0, -y end, { density = density })
  scene:pin(triangles.where(ids, corners, function(_, y) return y < 1e-9 end))
  scene:force("membrane", { triangles = faces, uv = uv, stiffness = Y, damping = 0.1 })
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:force("drag", { rate = 5 })
  local s = validation.rest(scene, 1, 1e-11, 60):state()
  local low, sum = triangles.where(ids, corners, function(_, y) return y > 1 - 1e-9 end), 0
  for _, id in ipairs(low) do sum = sum - s:position(id)[3] end
  return sum / #low - 1
end

return validation.problem {
  title = "Membrane stretched by its own weight, on three meshes",
  quantities = {
    { name = "regular", unit = "m", reference = stretch, source = source },
    { name = "alternating", unit = "m", reference = stretch, source = source },
    { name = "irregular", unit = "m", reference = stretch, source = source },
  },
  space = { 8, 16, 32 },
  order = {},
  noise = 1e-4, -- the corners of one row hang by different weights: 2e-5 at n = 32, with either sign
  tolerance = 1e-4,
  why = "the mean of the lowest row, whose corners have different weights: errors of order 2 and more, 2e-5 at n = 32",
  forces = { membrane = { "triangles", "uv", "stiffness", "damping" } },
  quick = { space = { 3, 4, 6 }, tolerance = 0.05 },
  solve = function(at)
    local list = {}
    for k, kind in ipairs(triangles.kinds) do list[k] = hang(kind, at.n) end
    return list
  end,
}
