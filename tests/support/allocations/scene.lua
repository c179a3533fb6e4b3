-- Small scenes which together have every force, constraint, corrector and output at work, for tests in which an
-- allocation fails; run.lua says with which methods. usage: hooke run scene.lua part=NAME
local part = param("part", "rope", "which of them")
local parts = {}

function parts.rope(scene)
  local rope = scene:strand { n = 5, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 0.1 }
  scene:pin { 1 }
  scene:force("gravity", {})
  scene:force("springs", { edges = rope:edges(), k = 100, damping = 0.1 })
  scene:measure("low", function(s) return s:position(4)[3] end)
  scene:output("table", {})
end

function parts.winds(scene)
  scene:channel("temperature", { initial = 310 })
  scene:particles { positions = { { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 2 } }, mass = 1 }
  scene:force("central", { strength = 1, power = 1 })
  scene:force("drag", { rate = 1 })
  scene:force("field", { f = function(_, x) return -x, 0, 0 end })
  scene:force("magnetic", { B = { 0, 0, 2 }, ratio = 1 })
  scene:force("nbody", { G = 1, opening_angle = 0.5 })
  scene:force("lennard_jones", { epsilon = 1e-3, sigma = 0.5 })
  scene:force("turbulence", { speed = 0.1, largest = 1, smallest = 0.5, rate = 1 })
  scene:force("vortex", { strength = 2, core = 0.2, profile = "rankine", rate = 1 })
  scene:force("wind", { on = "particles", rate = 1, velocity = { 1, 0, 0 } })
  scene:force("relax", { channel = "temperature", rate = 0.7, target = { 300 } })
  scene:force("buoyancy", { ambient = 300, g = { 0, 0, -1 } })
  scene:force("pull", { particles = { 1 }, k = 1 })
  scene:force("sph", { c = 0.1, spacing = 0.5, density = 8 })
  scene:force("viscosity", { mu = 0.1, spacing = 0.5, density = 8 })
  scene:force("surface_tension", { tension = 1e-3, spacing = 0.5, density = 8 })
end

function parts.grains(scene)
  scene:channel("spin", { initial = { 0, 0, 0 } })
  scene:particles { positions = { { 0, 0, 0.099 }, { 0.19, 0, 0.1 }, { 0.1, 0.15, 0.1 } }, mass = 0.1 }
  scene:force("gravity", {}) -- below: soft enough for the step, so that the verdict hangs on no comparison
  scene:force("soft_spheres", { radius = 0.1, stiffness = 2, spin = "spin" })
  scene:force("soft_walls", { planes = { 0, 0, 1, 0 }, radius = 0.1, stiffness = 2, spin = "spin" })
  scene:source("emitter", { rate = 60, lifetime = 0.02, speed = 1, position = { 2, 0, 0.5 }, mass = 0.1 })
  scene:output("checkpoint", {})
end

function parts.sheet(scene)
  local sheet = scene:grid { nx = 3, ny = 3, width = 0.2, height = 0.2, mass = 0.1, origin = { 0, 0, 0.06 } }
  scene:body { shape = "sphere", radius = 0.05, detail = 0.04, position = { 0.1, 0.1, 0 } }
  scene:force("gravity", {})
  scene:force("membrane", { stiffness = 50, damping = 0.001 })
  scene:force("hinges", { rigidity = 1e-4 })
  scene:force("quadratic_bending", { rigidity = 1e-4 })
  scene:force("penalty", { shape = "plane", k = 100 })
  scene:force("repulsion", { stiffness = 100 })
  scene:force("follower", { edges = { { 1, 2 } }, f = 0.01 })
  scene:corrector("obstacle", { shape = "plane", radius = 0.01 })
  scene:corrector("strain_limit", { edges = sheet:structural(), limit = 0.1 })
  scene:corrector("contact", {})
  scene:corrector("impact_zones", {})
  scene:corrector("untangle", {})
end

function parts.solid(scene)
  local cube = scene:block { nx = 2, ny = 2, nz = 2, size = { 0.1, 0.1, 0.1 }, density = 1000, origin = { 0, 0, 0.1 } }
  scene:force("gravity", {})
  scene:force("neo_hookean", { tetrahedra = cube:tetrahedra(), E = 1e4, nu = 0.4 })
  scene:force("volume", { tetrahedra = cube:tetrahedra(), k = 1e3 })
  scene:force("barrier", { d_hat = 0.01 })
end

function parts.water(scene)
  local positions = {}
  for k = 0, 11 do positions[k + 1] = { 0.1 * (k % 4) + 0.05, 0, 0.1 * (k // 4) + 0.05 } end
  scene:particles { positions = positions, mass = 2 }
  local sheet = scene:mesh { vertices = { { 0.3, -0.1, 0.3 }, { 0.6, -0.1, 0.2 }, { 0.4, 0.2, 0.25 } }, faces = { { 1, 2, 3 } }, mass = 1 }
  scene:pin({ sheet:ids()[1] }, { normal = { 0, 1, 0 } })
  scene:force("gravity", {})
  scene:corrector("liquid", { low = { 0, 0, 0 }, high = { 0.8, 0, 0.4 }, cell = 0.2 })
end

function parts.smoke(scene)
  local vent = scene:particle { position = { 0.1, 0, 0.1 }, mass = 1 }
  scene:pin({ vent })
  scene:corrector("gas", { low = { 0, 0, 0 }, high = { 0.8, 0, 0.8 }, cell = 0.2, sources = { vent }, source_smoke = 1e-3 })
end

function parts.drops(scene)
  scene:particles { positions = { { 0, 0, 0.1 }, { 0.1, 0, 0.1 }, { 0, 0.1, 0.1 } }, mass = 1 }
  scene:force("gravity", {})
  scene:corrector("incompressible", { spacing = 0.1 })
end

function parts.hair(scene)
  local hair = scene:strand { n = 4, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 0.1 }
  scene:force("rods", { edges = hair:edges(), EI = 0.01, GJ = 0.01 })
  scene:force("angle_springs", { edges = hair:edges(), EI = 0.01 })
  scene:force("cubic_springs", { edges = hair:edges(), k = 10 })
end

function parts.links(scene)
  scene:particles { positions = { { 0, 0, 1 }, { 1, 0, 1 }, { 2, 0, 1 }, { 2, 0, 1 }, { 3, 0, 1 }, { 0, 3, 0 } }, mass = 1 }
  scene:pin { 1 }
  scene:force("gravity", {})
  scene:force("ropes", { edges = { { 2, 3 } }, k = 10, rest = 0.9 })
  scene:constraint("bars", { edges = { { 1, 2 } } })
  scene:constraint("weld", { edges = { { 3, 4 } } })
  scene:constraint("cables", { edges = { { 4, 5 } } })
  scene:constraint("surface", { particles = { 6 }, shape = "plane" })
end

-- ---- outputs of which each has a library of many allocations ----

function parts.recorded(scene)
  parts.rope(scene)
  scene:output("trajectory", {})
end

function parts.pictured(scene)
  parts.rope(scene)
  scene:output("frames", { width = 16, height = 16, video = false })
end

local scene = hooke.scene { duration = 0.05, fps = 60, dt = 1 / 240 }
parts[part](scene)
return scene
