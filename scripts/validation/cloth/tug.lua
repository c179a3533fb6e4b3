-- One end of a sheet is tugged: how many steps until the other end hears of it. An explicit step carries news by one
-- cell, however long it is, so that the stable step, which gets shorter with the cells, is not the only bound; an
-- implicit step solves for all particles at once.
local validation = require("validation")

local density, Y = 0.15, 200

local function steps_to_cross(n, integrator)
  local a = 1 / n
  local h = 0.7 * a * math.sqrt(density / Y)
  local scene = hooke.scene { duration = 2 * n * h, fps = validation.fps(h), dt = h, integrator = integrator }
  local sheet = scene:grid { nx = n + 1, ny = 3, width = 1, height = 2 * a, density = density }
  local first = { sheet:at(1, 1), sheet:at(1, 2), sheet:at(1, 3) }
  scene:pin(first, { path = function(t) return -t, 0, 0 end })
  scene:force("springs", scene:membrane(sheet, { stiffness = Y }))
  local last, count = sheet:at(n + 1, 2), 0
  validation.each(scene, h, 2 * n, function(s, t)
    if t > 0 then count = count + 1 end
    return s:velocity(last)[1] ~= 0
  end)
  return count
end

return validation.problem {
  title = "Steps in which a tug crosses a sheet",
  quantities = {
    { name = "explicit, a cell", unit = "steps", reference = 1,
      source = "one evaluation of the forces sees neighbours only" },
    { name = "implicit", unit = "steps", reference = 1, source = "the inverse of the step's matrix is full" },
  },
  space = { 4, 8, 16 },
  order = {},
  tolerance = 0.3,
  why = "counts, and one step more or less where the tug begins",
  quick = { space = { 4, 5, 6 } },
  solve = function(at)
    return { steps_to_cross(at.n, "symplectic_euler") / at.n, steps_to_cross(at.n, "backward_euler") }
  end,
}
