-- A plate that is flat at rest, rolled into a tube: 1/2 B kappa^2 per area. Equilateral triangles around the tube, n in
-- a row; hinges across the two open ends are missing, which the difference of a long and a short tube leaves out.
local validation = require("validation")

local B, R, H = 0.7, 0.5, 1

local function energy(n, rows, across)
  local scene = hooke.scene { duration = 0 }
  local vertices, faces = {}, {}
  for j = 0, rows do
    for i = 0, n - 1 do
      local angle = 2 * math.pi * (i + j % 2 / 2) / n
      vertices[#vertices + 1] = { R * math.cos(angle), R * math.sin(angle), across * j }
    end
  end
  local function id(i, j) return j * n + i % n + 1 end
  for j = 0, rows - 1 do
    for i = 0, n - 1 do
      local s = j % 2
      faces[#faces + 1] = { id(i, j), id(i + 1, j), id(i + s, j + 1) }
      faces[#faces + 1] = { id(i + 1 - s, j), id(i + 1, j + 1), id(i, j + 1) }
    end
  end
  scene:mesh { vertices = vertices, faces = faces }
  scene:force("hinges", { rigidity = B, rest = 0 })
  return scene:run { to = 0 }:state():potential()
end

return validation.problem {
  title = "Bending energy of a tube",
  quantities = {
    { name = "energy", unit = "J", reference = math.pi * B * H / R,
      source = "closed form, 1/2 B/R^2 times the area 2 pi R H" },
  },
  space = { 16, 32, 64 },
  order = { space = 2 },
  tolerance = 1e-4,
  why = "errors of order 2, 3e-3 at n = 64, leave those of order 4",
  forces = { hinges = { "rigidity", "rest" } },
  quick = { space = { 8, 12, 16 }, tolerance = 1e-2 },
  solve = function(at)
    local n = at.n
    local side = 2 * R * math.sin(math.pi / n)
    local across = math.sqrt(3) / 2 * side -- rows of triangles that are equilateral but for the bend
    local rows = 2 * math.floor(H / across / 2 + 0.5)
    return (energy(n, 2 * rows, across) - energy(n, rows, across)) * H / (rows * across)
  end,
}
