-- A sheet that hangs from its upper border is stretched by its own weight: with nu = 0 every thread by itself, by
-- rho g L^2/(2 Y) at the end. Cells are 1/n wide and high; a border of whole particles and springs would be off by 1/n.
local validation = require("validation")

local density, g, Y = 0.2, 10, 16

return validation.problem {
  title = "Sheet stretched by its own weight",
  quantities = {
    { name = "stretch", unit = "m", reference = density * g / (2 * Y),
      source = "closed form, rho g L^2/(2 Y), L = 1 m" },
    { name = "tension at the top", unit = "N/m", reference = density * g, source = "closed form, rho g L" },
  },
  space = { 4, 8, 16 },
  order = {},
  noise = 1e-11, -- of the equilibrium, whose speeds are below 1e-12 m/s
  tolerance = 1e-10,
  why = "exact at any n but for the last motion: half a cell's mass is at the end, and each row adds its weight",
  forces = { springs = { "edges", "k", "damping" } },
  quick = { space = { 2, 3, 4 }, tolerance = 1e-10 },
  solve = function(at)
    local n = at.n
    local scene = hooke.scene { duration = 60, fps = 2, dt = 0.02, integrator = "backward_euler" }
    local sheet = scene:grid { nx = n + 1, ny = n + 1, density = density, v = { 0, 0, -1 } }
    local top = {}
    for i = 1, n + 1 do top[i] = sheet:at(i, 1) end
    scene:pin(top)
    scene:force("springs", scene:membrane(sheet, { stiffness = Y, nu = 0, damping = 1 }))
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:force("drag", { rate = 5 })
    local s = validation.rest(scene, 1, 1e-12, 60):state()
    local pull = density * g / (2 * n) -- the weight of the upper row itself
    for i = 1, n + 1 do pull = pull - s:force("springs", top[i])[3] end
    return { -1 - s:position(sheet:at(1, n + 1))[3], pull }
  end,
}
