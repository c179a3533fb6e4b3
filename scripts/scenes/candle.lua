-- candle.lua: vapour of wax from a wick burns: it heats the gas, which rises, glows by the law of Wien and cools, and
-- leaves a little soot. The flame's length is where the fuel is burnt.
local cell = param("cell", 0.003, "of the grid, m", { min = 5e-4 })
local rate = param("rate", 15, "at which fuel burns, 1/s", { min = 0 })

local scene = hooke.scene { duration = 1, fps = 60, dt = 1 / 240, integrator = "symplectic_euler" }
local air = 293

local wick = {}
for k = 0, 3 do wick[k + 1] = scene:particle { position = { 0, 0, 0.044 + 0.003 * k }, mass = 1, group = "wick" } end
scene:pin(wick)

scene:corrector("obstacle", { shape = "cylinder", size = { 0.024, 0.024, 0.06 }, position = { 0, 0, 0.005 }, label = "wax" })
scene:corrector("gas", { low = { -0.04, -0.04, 0 }, high = { 0.04, 0.04, 0.2 }, cell = cell, open = "sides", ambient = air,
  viscosity = 1e-4, diffusivity = 1e-4, sources = wick, source_radius = 0.006, source_time = 0.01, source_fuel = 1,
  source_temperature = 1200, burn_rate = rate, burn_heat = 1400, radiation = 1500, soot = 2e-5,
  expansion = 1 / 1500 })

scene:measure("hottest", function(s) -- along the wick
  local most = 0
  for _, id in ipairs(wick) do most = math.max(most, s:field("temperature", id)) end
  return most
end, { unit = "K" })
scene:output("frames", { width = 540, height = 960, smoke = 8700, glow = 4000, color = "none", particles = "off",
  boxes = { 0, 0, 0.041, 0.0015, 0.0015, 0.014 }, from = { 0, -0.36, 0.11 }, look_at = { 0, 0, 0.075 },
  ground_height = -0.025, light = "night" })
return scene
