-- plume.lua: warm smoke rises from a vent, meets a ball and closes again above it. The gas is on a grid: it is carried,
-- rises by its warmth and is kept free of divergence by pressure; pictures show the smoke by the law of Beer and Lambert.
local cell = param("cell", 0.025, "of the grid, m", { min = 5e-3 })
local warm = param("warm", 60, "by which the vent is warmer than the air, K", { min = 0 })
local whirls = param("whirls", 0.15, "confinement of vortices; 0: none", { min = 0 })

local scene = hooke.scene { duration = 4, fps = 30, dt = 1 / 60, integrator = "symplectic_euler" }
local air = 293

local vent = scene:particle { position = { 0.02, 0, 0.12 }, mass = 1 }
scene:pin({ vent })
local tracer = scene:particle { position = { 0.05, 0.03, 0.25 }, mass = 1e-3 }

scene:corrector("obstacle", { shape = "sphere", size = { 0.3, 0.3, 0.3 }, position = { 0, 0, 0.62 } })
scene:corrector("gas", { low = { -0.5, -0.5, 0 }, high = { 0.5, 0.5, 1.6 }, cell = cell, open = "sides", ambient = air,
  sources = { vent }, source_radius = 0.09, source_temperature = air + warm, source_smoke = 3e-3, confinement = whirls })

scene:measure("height", function(s) return s:position(tracer)[3] end, { unit = "m" })
scene:output("frames", { width = 720, height = 960, smoke = 8700, color = "none", particles = "off",
  plain = { 0.75, 0.3, 0.2 }, from = { 0.6, -3.4, 0.95 }, look_at = { 0, 0, 0.76 }, ground_height = 0, light = "night" })
return scene
