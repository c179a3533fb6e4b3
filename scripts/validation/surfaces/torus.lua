-- A torus of radii 1 and 0.4: a surface with a hole. Its tube is 6 cells wide at the coarsest level.
local surfaces = require("_surfaces")

local function f(x, y, z)
  local d = math.sqrt(x * x + y * y) - 1
  return 0.16 - d * d - z * z
end

return surfaces.problem {
  title = "Torus",
  shape = { f = f },
  gradient = function(x, y, z)
    local r = math.sqrt(x * x + y * y)
    return x * (1 - 1 / r), y * (1 - 1 / r), z
  end,
  half = 1.8,
  area = 4 * math.pi ^ 2 * 0.4,
  volume = 2 * math.pi ^ 2 * 0.16,
  euler = 0,
  space = { 24, 48, 96 },
  quick = { 20, 28, 40 },
  source = "Pappus' theorems",
}
