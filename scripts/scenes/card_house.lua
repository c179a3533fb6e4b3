-- card_house.lua: cards of stiff paper lean against each other in pairs, with one across and a pair on top. Friction
-- alone holds them: with mu above half of the tangent of their slope the house stands, with friction=0.05 it slides
-- apart.
local drape = require("drape")
local N = param("N", 5, "particles across a card", { min = 3, max = 64 })
local thickness = param("thickness", 4e-3, "of a card in contact, m", { min = 1e-5 })
local friction = param("friction", 0.8, "Coulomb's mu", { min = 0 })
local contact = param("contact", "impulses", "impulses, barrier, force, zones")

-- Impulses on what rests err by the square of the step, and next to nothing moves here beside which that is small.
local scene = drape.scene(contact, { duration = 3, dt = 4e-5 })
scene:body { shape = "plane", size = 1.5 }
local cards, L, W, slope = 0, 0.28, 0.2, math.rad(20)

-- A card from (x, z) along the direction (dx, dz), W wide along y.
local function card(x, z, dx, dz, length)
  cards = cards + 1
  return drape.sheet(scene, { nx = N, ny = math.floor(length / W * (N - 1) + 0.5) + 1, width = W, height = length,
    origin = { x, -W / 2, z }, u = { 0, 1, 0 }, v = { dx, 0, dz }, group = "card " .. cards, density = 0.3,
    stiffness = 300, rigidity = 0.02, damping = 0.05, bend_damping = 2e-5 })
end

-- Two that lean on each other above x, from the height z on; a gap of a hundredth of the thickness to start with.
local function pair(x, z)
  local gap = 0.505 * thickness / math.cos(slope)
  for side = -1, 1, 2 do
    card(x + side * (L * math.sin(slope) + gap), z, -side * math.sin(slope), math.cos(slope), L)
  end
end

local storey = L * math.cos(slope) + 1.01 * thickness
local apart = L * math.sin(slope) + 0.6 * thickness / math.cos(slope) + 0.02
pair(-apart, 0.51 * thickness)
pair(apart, 0.51 * thickness)
card(-apart - 0.07, 0.51 * thickness + storey, 1, 0, 2 * apart + 0.14)
local top = 0.51 * thickness + storey + 1.01 * thickness
pair(0, top)
scene:force("drag", { rate = 2 })
drape.contact(scene, contact, { thickness = thickness, friction = friction })

scene:measure("height", function(s)
  local z = 0
  for _, i in ipairs(s:ids()) do z = math.max(z, s:position(i)[3]) end
  return z
end, { unit = "m" })
scene:output("frames", { color = "group", thickness = thickness, from = { 0.8, -1.5, 0.6 }, look_at = { 0, 0, 0.26 },
  fov = 27, ground_height = 0 })
return scene
