-- metaballs.lua: pairs of soft metaballs, from nearly one to apart, fall on a floor and bounce: each is a filling of
-- tetrahedra of the same two blobs, which merge where their falloffs meet.
local pairs_of = param("pairs", 5, "pairs of balls", { min = 1, max = 9 })
local size = param("size", 0.08, "of a cell, m", { min = 0.02, max = 0.15 })
local E = param("E", 2e4, "Young's modulus, Pa", { min = 1000 })

local scene = hooke.scene { duration = 1, fps = 60, integrator = "leapfrog" }
local radius = 0.16 -- m
scene:force("gravity", { g = { 0, 0, -9.81 } })
local all = {}
for k = 1, pairs_of do
  local apart = radius * (0.4 + 2 * (k - 1) / math.max(pairs_of - 1, 1))
  local x = 0.55 * (k - (pairs_of + 1) / 2)
  local body = scene:implicit { as = "solid", size = size, density = 1000,
    blobs = { { x, 0, 0.6 - apart / 2, radius = radius }, { x, 0, 0.6 + apart / 2, radius = 0.75 * radius } } }
  scene:force("neo_hookean", { tetrahedra = body:tetrahedra(), E = E, nu = 0.4, damping = 0.002 * E,
    label = "pair " .. k })
  all[#all + 1] = body
end
scene:corrector("obstacle", { shape = "plane", normal = { 0, 0, 1 }, friction = 0.3 })

scene:measure("lowest", function(s)
  local z = math.huge
  for _, body in ipairs(all) do
    for _, i in ipairs(body:ids()) do z = math.min(z, s:position(i)[3]) end
  end
  return z
end, { unit = "m" })
scene:output("frames", { color = "none", springs = "off", particles = "off", from = { 0.8, -4.2, 1.1 },
  look_at = { 0, 0, 0.42 }, fov = 21, ground_height = 0 })
return scene
