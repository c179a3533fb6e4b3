-- cloth_on_sphere.lua: a square of cloth falls on a ball, drapes over it and hangs down in folds that touch each other.
-- Nothing passes through anything: the summary has the intersections, counted exactly at every frame. contact =
-- "impulses" corrects the steps of an explicit method, "barrier" is a force for an implicit one.
local drape = require("drape")
local N = param("N", 41, "particles along one side", { min = 3, max = 512 })
local thickness = param("thickness", 4e-3, "of the cloth in contact, m", { min = 1e-5 })
local friction = param("friction", 0.3, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

local scene = drape.scene(contact, { duration = 1.5 })
scene:body { shape = "sphere", radius = 0.25, position = { 0, 0, 0.45 }, detail = 3e-3 }
local cloth = drape.sheet(scene, { nx = N, ny = N, width = 1, height = 1, origin = { -0.5, -0.5, 0.72 },
  u = { 1, 0, 0 }, v = { 0, 1, 0 } })
scene:force("drag", { rate = 1 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

scene:measure("lowest", drape.lowest(cloth:ids()), { unit = "m" })
scene:output("frames", { color = "none", thickness = thickness, from = { 0.9, -1.9, 1.15 }, look_at = { 0, 0, 0.4 },
  fov = 26, ground_height = 0 })
return scene
