-- ice_sheet.lua: a lantern hangs by a bar from a sheet of ice in a frame, and a burner stands under the sheet. The sheet
-- softens where it is warm and sags; what has molten is held by nothing and falls, as grains that come to rest in a heap;
-- and the lantern falls when its bar has molten, or the sheet around it (Terzopoulos, Platt, Fleischer 1989). So that this
-- takes seconds, the burner gives some tens of times the heat of a real one. Ice here is as soft as rubber.
local heat = require("heat")
local burner = param("burner", 1000, "convection of the flame, W/(m^2 K)", { min = 0 })
local n = param("n", 21, "particles along a side", { min = 5, max = 101 })
local duration = param("duration", 3, "s", { min = 0 })
local side, thickness, up, bar = 0.4, 0.005, 0.3, 0.12 -- m: of the sheet; its height above the floor; of the bar
local dx = side / (n - 1)
local latent = heat.enthalpy("ice", 273.15, 1)

local scene = hooke.scene { duration = duration, fps = 30, integrator = "symplectic_euler" }
scene:channel("enthalpy", { initial = heat.enthalpy("ice", 270) })
scene:channel("given", { initial = 0 })
scene:channel("radius", { initial = 0.45 * dx })
local ids, rim, triangles, mass = {}, {}, {}, 917 * thickness * dx * dx -- kg
for i = 0, n - 1 do
  for j = 0, n - 1 do
    local id = scene:particle { position = { i * dx - side / 2, j * dx - side / 2, up }, mass = mass, group = "ice" }
    ids[#ids + 1] = id
    if i == 0 or j == 0 or i == n - 1 or j == n - 1 then rim[#rim + 1] = id end
  end
end
for i = 1, n - 1 do
  for j = 1, n - 1 do
    local a, b, c, d = ids[(i - 1) * n + j], ids[i * n + j], ids[i * n + j + 1], ids[(i - 1) * n + j + 1]
    if (i + j) % 2 == 0 then
      triangles[#triangles + 1], triangles[#triangles + 2] = { a, b, c }, { a, c, d }
    else
      triangles[#triangles + 1], triangles[#triangles + 2] = { a, b, d }, { b, c, d }
    end
  end
end
local middle = ids[#ids // 2 + 1]
local lantern = scene:particle { position = { 0, 0, up - bar }, mass = 0.2, radius = 0.025, group = "lantern" }
scene:pin(rim)

scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("melting_membrane", { triangles = triangles, stiffness = 4e3, damping = 1e-4, breaking = 0.5, channel = "enthalpy",
  softens = 0, range = latent / 2 })
scene:constraint("melting_bars", { edges = { { middle, lantern } }, channel = "enthalpy", melts = latent / 4 })
local ice = { material = "ice", channel = "enthalpy", account = "given" }
local function with(more)
  for name, value in pairs(ice) do more[name] = value end
  return more
end
scene:force("conduction", with { triangles = triangles, thickness = thickness })
scene:force("heating", with { particles = ids, area = 2 * dx * dx, convection = 20, surroundings = 293, label = "air" })
scene:force("heating", with { particles = ids, area = dx * dx, convection = burner, surroundings = 1500, label = "burner", shape = "sphere",
  size = { 0.12, 0.12, 0.12 }, position = { 0.03, 0, up - 0.04 }, reach = 0.02 })
scene:force("soft_spheres", { radii = "radius", stiffness = 1e3, restitution = 0.6, friction = 0.4 })
scene:force("soft_walls", { radii = "radius", stiffness = 1e3, restitution = 0.6, friction = 0.4, label = "floor" })

scene:measure("fallen", function(s) -- particles of the ice
  local count = 0
  for _, id in ipairs(ids) do count = count + (s:position(id)[3] < up / 2 and 1 or 0) end
  return count
end)
scene:measure("lantern", function(s) return s:position(lantern)[3] end, { unit = "m" }) -- its height
heat.measure_balance(scene, ids)
scene:output("frames", { color = "enthalpy", range = { -7000, 330e3 }, unit = "J/kg", map = "viridis", size = "radius",
  from = { 0.55, -0.95, 0.55 }, look_at = { 0, 0, 0.17 }, ground_height = 0, fov = 28 })
return scene
