-- materials.lua: six cloths of 24 cm on round tables of 10 cm fall over the edge, as in the textile industry's test of drape
-- (Cusick 1968). In front are denim, polyester and cotton, which stand off the more, the stiffer they are for their weight;
-- behind them rubber, silk and a knit, which hang down. What each is made of, and who measured it, is in
-- scripts/lib/material_numbers.lua. The bending length (B/(density g))^(1/3) is how long a ribbon holds itself up, more or
-- less; the measures are how far the corners fall.
local materials = require("material_numbers")
local N = param("N", 11, "particles along one side; 25 shows finer folds, and takes minutes to verify", { min = 7, max = 200 })
local side, table_radius, g = 0.24, 0.05, 9.81

local scene = hooke.scene { duration = 1.2, fps = 60, dt = 1 / 240, integrator = "bdf2" }

local function cloth(name, x, y)
  local sheet = scene:grid { nx = N, ny = N, width = side, height = side, origin = { x - side / 2, y - side / 2, 0 },
    material = name, alternating = true, group = name }
  local held, corners = {}, { sheet:at(1, 1), sheet:at(N, 1), sheet:at(1, N), sheet:at(N, N) }
  for j = 1, N do
    for i = 1, N do
      local u, v = (i - 1) / (N - 1) - 0.5, (j - 1) / (N - 1) - 0.5
      if side * math.sqrt(u * u + v * v) < table_radius then held[#held + 1] = sheet:at(i, j) end
    end
  end
  scene:pin(held)
  scene:force("membrane", { triangles = sheet:triangles(), material = name, damping = 0.002, label = name .. " membrane" })
  scene:force("hinges", { triangles = sheet:triangles(), material = name, label = name .. " hinges",
    damping = 0.01 * materials[name].hinges.rigidity })
  scene:measure(("corners of %s, of bending length %.1f cm, in cm"):format(name,
    100 * (materials[name].hinges.rigidity / (materials[name].grid.density * g)) ^ (1 / 3)), function(s)
    local fall = 0
    for _, id in ipairs(corners) do fall = fall - 25 * s:position(id)[3] end
    return fall
  end)
end

for k, name in ipairs { "rubber", "silk", "knit", "denim", "polyester", "cotton" } do
  cloth(name, 0.3 * ((k - 1) % 3), -0.3 * ((k - 1) // 3))
end
scene:force("gravity", { g = { 0.3, 0.2, -g } }) -- hardly askew, so that no fold is exactly symmetric
scene:force("drag", { rate = 6 })

scene:output("frames", { width = 1280, height = 720, color = "group", from = { 0.3, -1.05, 0.55 },
  look_at = { 0.3, -0.17, -0.05 }, ground_height = -0.14 })
return scene
