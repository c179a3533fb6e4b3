-- ice_cube.lua: a cube of ice is let go in warm water: it bobs up, floats and melts from its skin. Ice is water that is too
-- viscous to flow, and lighter by 8.3 % (the force buoyancy asks `melt` what is solid). So that this takes seconds, heat goes
-- a thousand times as fast as in still water, which stands for the stirring of real convection, too. Measured are the ice that
-- is left, the cube's height, and the heat of all, which nothing but rounding changes: nothing comes from outside.
local filling, heat = require("filling"), require("heat")
local cell = param("cell", 0.01, "of the grid, m", { min = 0.004, max = 0.02 })
local warm = param("warm", 313, "of the water, K", { min = 274, max = 370 })
local faster = param("faster", 1000, "times that heat goes", { min = 1 })
local duration = param("duration", 2, "s", { min = 0 })
local half, level, cube = 0.06, 0.08, 0.04 -- m: of the glass's side; of the water; of the cube's side
local low, high, density = { -half, -half, 0 }, { half, half, 0.12 }, 1000
local bottom = 0.02                        -- m, of the cube at the start

local scene = hooke.scene { duration = duration, fps = 30, integrator = "symplectic_euler" }
scene:channel("enthalpy", { initial = heat.enthalpy("ice", warm) })
scene:channel("seen", { initial = 0.05 }) -- in pictures: what was ice stands out
local function inside(x, y, z)
  return math.max(math.abs(x), math.abs(y), math.abs(z - bottom - cube / 2)) < cube / 2
end
local water = filling.box { low = low, high = { half, half, level }, cell = cell, density = density }
local ids, cold = {}, {}
for k, p in ipairs(water.positions) do
  local frozen = inside(p[1], p[2], p[3])
  ids[k] = scene:particle { position = p, mass = water.mass, group = frozen and "ice" or "water",
    enthalpy = heat.enthalpy("ice", frozen and 263 or warm), seen = frozen and 1 or nil }
  if frozen then cold[#cold + 1] = ids[k] end
end
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("grid_conduction", { low = low, high = high, cell = cell, density = density, material = "ice",
  conductivity = 2.16 * faster, conductivity_liquid = 0.561 * faster, channel = "enthalpy" })
scene:force("melt", { channel = "enthalpy", material = "ice", viscosity = 0.0018, solid = 1e5 })
scene:force("buoyancy", { of = "melt", ambient = 277, beta = 2e-4, lighter = 0.083 })
filling.tank(scene, low, high)
scene:corrector("liquid", { low = low, high = high, cell = cell, density = density, viscosity_of = "melt" })

scene:measure("ice", function(s) -- that are solid
  local sum = 0
  for _, id in ipairs(cold) do sum = sum + water.mass * (1 - s:field("molten", id)) end
  return sum
end, { unit = "kg" })
scene:measure("height", function(s) -- of the middle of what was ice
  local z = 0
  for _, id in ipairs(cold) do z = z + s:position(id)[3] / #cold end
  return z
end, { unit = "m" })
scene:measure("heat", function(s)
  local sum = 0
  for _, id in ipairs(ids) do sum = sum + water.mass * s:channel("enthalpy", id) end
  return sum
end, { unit = "J" })
scene:output("frames", { color = "enthalpy", range = { -21e3, 503e3 }, unit = "J/kg", map = "cividis", reverse = true, fade = "seen",
  radius = 0.32 * cell, obstacles = false, from = { 0.2, -0.36, 0.17 }, look_at = { 0, 0, 0.045 }, ground_height = 0, fov = 22 })
return scene
