-- A strip is pulled a little at both ends, all of it free to narrow: by how much is Poisson's ratio, of springs, of
-- membranes of triangles and of rubber, and the pull is Young's modulus. The levels are the strain.
local validation = require("validation")

local Y, long, wide = 20, 0.4, 0.2
local sheets = {
  { name = "springs on squares", nu = 1 / 3, force = function(scene, cloth, nu)
    return "springs", scene:membrane(cloth, { stiffness = Y, nu = nu })
  end },
  { name = "StVK", nu = 0.3, force = function(_, cloth, nu)
    return "membrane", { triangles = cloth:triangles(), model = "stvk", stiffness = Y, nu = nu }
  end },
  { name = "rubber", nu = 0.5, force = function(_, cloth, nu)
    return "membrane", { triangles = cloth:triangles(), model = "neo_hookean", stiffness = Y, nu = nu }
  end },
  { name = "Baraff-Witkin", nu = 0, force = function(_, cloth)
    return "membrane", { triangles = cloth:triangles(), model = "baraff_witkin", stiffness = Y }
  end },
}

-- Narrowing over the elongation, and the pull per width over it.
local function stretched(sheet, strain)
  local scene = hooke.scene { duration = 60, fps = 2, dt = 0.1, integrator = { "backward_euler", tolerance = 1e-12 } }
  local nx, ny = 9, 5
  local cloth = scene:grid { nx = nx, ny = ny, width = long, height = wide, density = 0.1 }
  local force, p = sheet.force(scene, cloth, sheet.nu)
  p.label = "sheet"
  scene:force(force, p)
  scene:force("drag", { rate = 10 })
  local share, ends = {}, {} -- of the pull, for each particle at the ends
  for j = 1, ny do
    for side, i in pairs { [-1] = 1, [1] = nx } do
      local id = cloth:at(i, j)
      ends[#ends + 1], share[id] = id, side * Y * strain * wide / (ny - 1) * ((j == 1 or j == ny) and 0.5 or 1)
    end
  end
  scene:force("field", { only = ends, f = function(_, _, _, _, _, _, _, id) return share[id], 0, 0 end })
  local state = validation.rest(scene, 1, 1e-12, 60):state()
  local function extent(id, other, c) return state:position(other)[c] - state:position(id)[c] end
  local longer = extent(cloth:at(1, 3), cloth:at(nx, 3), 1) / long - 1
  return (1 - extent(cloth:at(5, 1), cloth:at(5, ny), 2) / wide) / longer, Y * strain / longer
end

local quantities = {}
for _, sheet in ipairs(sheets) do
  quantities[#quantities + 1] = { name = "Poisson's ratio, " .. sheet.name, reference = sheet.nu,
    scale = 1, source = "the number that is asked for" }
  quantities[#quantities + 1] = { name = "Young's modulus, " .. sheet.name, unit = "N/m", reference = Y,
    source = "the number that is asked for" }
end

return validation.problem {
  title = "A strip that is stretched a little",
  quantities = quantities,
  time = { 4e-3, 2e-3, 1e-3 },
  time_label = "strain",
  order = {},
  noise = 1e-8,
  tolerance = 2e-5,
  why = "what is left is of second order in the strain",
  quick = { time = { 1e-2, 5e-3, 2.5e-3 }, tolerance = 1e-3 },
  solve = function(at)
    local found = {}
    for _, sheet in ipairs(sheets) do
      local nu, stiffness = stretched(sheet, at.h)
      found[#found + 1], found[#found + 2] = nu, stiffness
    end
    return found
  end,
}
