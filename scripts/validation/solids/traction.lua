-- A bar is drawn out by an even pull p on its end, all others free to move: it grows longer by p/E, narrower by nu p/E,
-- and, for nu = 0.49, hardly larger, by (1 - 2 nu) p/E. The stress is the same everywhere, so that the mesh does not
-- matter; the levels are the strain p/E.
local validation = require("validation")

local E, nu, n = 1e5, 0.49, 3 -- n cells along, one across

return validation.problem {
  title = "Bar under an even pull",
  quantities = {
    { name = "elongation/(p/E)", reference = 1, source = "closed form, Hooke's law" },
    { name = "narrowing/(p/E)", reference = nu, source = "closed form, Hooke's law" },
    { name = "growth of volume/(p/E)", reference = 1 - 2 * nu, source = "closed form, Hooke's law", scale = 1 },
  },
  time = { 4e-3, 2e-3, 1e-3 },
  time_label = "strain",
  order = { time = 1 },
  noise = 1e-7, -- of the equilibrium, whose speeds are below 1e-11 m/s
  tolerance = 2e-5,
  why = "what is left is of second order in the strain",
  forces = { neo_hookean = { "tetrahedra", "E", "nu", "damping" } },
  quick = { time = { 1e-2, 5e-3, 2.5e-3 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = 40, fps = 2, dt = 0.05, integrator = { "backward_euler", tolerance = 1e-12 } }
    local bar = scene:block { nx = n + 1, ny = 2, nz = 2, size = { n, 1, 1 }, density = 1000 }
    local share, ends = {}, {} -- of the end's area, for each of its particles
    for _, t in ipairs(bar:triangles()) do
      local all = true
      for _, id in ipairs(t) do all = all and (id - 1) % (n + 1) == n end
      for _, id in ipairs(all and t or {}) do
        if not share[id] then ends[#ends + 1] = id end
        share[id] = (share[id] or 0) + 0.5 / 3
      end
    end
    for j = 1, 2 do
      for k = 1, 2 do
        local id = bar:at(1, j, k)
        if j == 1 and k == 1 then scene:pin { id }
        elseif j == 2 and k == 1 then scene:pin({ id }, { axes = { 0, 1, 0 } })
        else scene:pin({ id }, { normal = { 1, 0, 0 } }) end
      end
    end
    local p = E * at.h
    scene:force("neo_hookean", { tetrahedra = bar:tetrahedra(), E = E, nu = nu, damping = 1e4 })
    scene:force("drag", { rate = 2 })
    scene:force("field", { only = ends, f = function(_, _, _, _, _, _, _, id) return p * share[id], 0, 0 end })
    local s = validation.rest(scene, 1, 1e-11, 40):state()
    local a, b = s:position(bar:at(1, 1, 1)), s:position(bar:at(n + 1, 2, 2))
    local long, wide, high = (b[1] - a[1]) / n, b[2] - a[2], b[3] - a[3]
    return { (long - 1) / at.h, (1 - wide) / at.h, (long * wide * high - 1) / at.h }
  end,
}
