-- A cube whose edges are springs, by the stiffness that scene:block computes of Young's modulus, is drawn out by an even
-- pull p: it grows longer by p/E and narrower by nu p/E with nu = 1/4, the only ratio that springs have. Inside that is so
-- for any mesh; free faces, half of whose particles have no diagonals, give way, by a part of the cells' size.
local validation = require("validation")

local E, strain = 1e5, 1e-6

return validation.problem {
  title = "Cube of springs under an even pull",
  quantities = {
    { name = "elongation/(p/E)", reference = 1, source = "closed form, Hooke's law" },
    { name = "narrowing/(p/E)", reference = 0.25, source = "closed form, Cauchy's relation lambda = mu" },
  },
  space = { 4, 8, 16 },
  order = { space = 1 },
  noise = 1e-6, -- of the equilibrium, whose speeds are below 1e-13 m/s
  tolerance = 0.02,
  why = "the faces' share is of order 1, 12 % of the narrowing at n = 16; that of edges and corners, of order 2, is left",
  forces = { springs = { "edges", "k" } },
  quick = { space = { 4, 6, 8 }, tolerance = 0.1 },
  solve = function(at)
    local n = at.n
    local scene = hooke.scene { duration = 200, fps = 0.5, dt = 2, integrator = { "backward_euler", tolerance = 1e-12 } }
    local cube = scene:block { nx = n + 1, ny = n + 1, nz = n + 1, density = 1000, E = E }
    local p, ends, share = E * strain, {}, {}
    for j = 1, n + 1 do
      for k = 1, n + 1 do
        local id = cube:at(n + 1, j, k)
        ends[#ends + 1] = id
        share[id] = (j % n == 1 and 0.5 or 1) * (k % n == 1 and 0.5 or 1) / n ^ 2
      end
    end
    local middle = n // 2 + 1
    for j = 1, n + 1 do
      for k = 1, n + 1 do
        local id = cube:at(1, j, k)
        if j == middle and k == middle then scene:pin { id }
        elseif j == 1 and k == middle then scene:pin({ id }, { axes = { 0, 1, 0 } })
        else scene:pin({ id }, { normal = { 1, 0, 0 } }) end
      end
    end
    scene:force("springs", { edges = cube:edges(), k = cube.stiffness })
    scene:force("drag", { rate = 2 })
    scene:force("field", { only = ends, f = function(_, _, _, _, _, _, _, id) return p * share[id], 0, 0 end })
    local s = validation.rest(scene, 2, 1e-13, 200):state()
    local a, b = s:position(cube:at(1, middle, middle)), s:position(cube:at(n + 1, middle, middle))
    local c, d = s:position(cube:at(middle, 1, middle)), s:position(cube:at(middle, n + 1, middle))
    return { (b[1] - a[1] - 1) / strain, (1 - (d[2] - c[2])) / strain }
  end,
}
