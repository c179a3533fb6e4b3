-- A straight rod that is curved at rest, by 2 pi/L, is clamped at one end and let go: it relaxes to a closed circle, without energy.
local validation = require("validation")

local curvature = 2 * math.pi

return validation.problem {
  title = "A rod of rest curvature relaxes to a circle",
  quantities = {
    { name = "radius", unit = "m", reference = 1 / curvature, source = "closed form, 1/curvature" },
    { name = "distance of its ends", unit = "m", reference = 0, scale = 1, order = {}, source = "closed form" },
    { name = "energy over that of the straight rod", reference = 0, scale = 1, order = {}, source = "closed form" },
  },
  space = { 24, 48, 96 },
  order = { space = 2 },
  tolerance = 1e-6,
  noise = 1e-7,
  why = "order 2 leaves errors of order 4, (pi/96)^4 = 1e-6 over some 4; at rest to 1e-8 m/s",
  forces = { rods = { "edges", "EI", "GJ", "curvature", "axis" } },
  quick = { space = { 6, 12, 24 }, tolerance = 1e-4 },
  solve = function(at)
    local n, positions, edges = at.n, {}, {}
    for i = -1, n do
      positions[i + 2] = { i / n, 0, 0 }
      if i >= 0 then edges[i + 1] = { i + 1, i + 2 } end
    end
    local scene = hooke.scene { duration = 10, fps = 20, integrator = "leapfrog" }
    scene:particles { positions = positions, mass = 1 / n }
    scene:pin { 1, 2 } -- an edge in the wall: a free straight rod could curl in any direction
    scene:force("springs", { edges = edges, k = 2000 * n })
    scene:force("rods", { edges = edges, EI = 1, GJ = 1, curvature = curvature, axis = { 0, 1, 0 } })
    scene:force("drag", { rate = 7 })
    local start = scene:run { to = 0 }:state():energy()
    local s = validation.rest(scene, 0.25, 1e-8, 10):state()
    local a, b, c = s:position(n // 2), s:position(n // 2 + 1), s:position(n // 2 + 2)
    local bend, edge = 0, 0
    for k = 1, 3 do
      bend = bend + (a[k] - 2 * b[k] + c[k]) ^ 2 -- 2 R (1 - cos psi), of nodes at angles psi on a circle
      edge = edge + (b[k] - a[k]) ^ 2            -- 4 R^2 sin^2(psi/2)
    end
    local first, last, gap = s:position(2), s:position(n + 2), 0
    for k = 1, 3 do gap = gap + (last[k] - first[k]) ^ 2 end
    return { edge / math.sqrt(bend), math.sqrt(gap), s:energy() / start }
  end,
}
