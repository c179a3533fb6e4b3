-- ragdoll.lua: a limp figure of capsules falls down stairs. Neck, shoulders and hips are ball joints, whose cones have no limits but
-- that all limbs meet (`contact`); elbows and knees are hinges that bend one way only. The measure `beyond` is how far a limit is
-- passed, rad; `height` is that of the chest, m.
local steps = param("steps", 5, "of the stairs", { min = 1 })
local T = param("duration", 2, "s", { min = 0.1 })
local mu = param("friction", 0.5, "")

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 500, integrator = "leapfrog" }

local g, tread, rise, base, gap = 9.81, 0.3, 0.17, 1.2, 1e-3
for k = 0, steps do
  local from, to = k == 0 and -1.2 or tread * (k - 1), k == steps and tread * steps + 1.5 or tread * k
  scene:body { shape = "box", size = { to - from - gap, 2, base - rise * k }, position = { (from + to) / 2, 0, -(base + rise * k) / 2 } }
end

-- A limb in the plane of `y`, from one x, z to another.
local function limb(y, from, to, radius)
  local x, z = to[1] - from[1], to[2] - from[2]
  local half = math.sqrt(x ^ 2 + z ^ 2) / 2 - radius
  local b = scene:rigid { shape = "capsule", radius = radius, length = 2 * half, density = 1000,
    position = { (from[1] + to[1]) / 2, y, (from[2] + to[2]) / 2 }, orientation = { 0, math.atan(x, z), 0 } }
  b:surface({ { 0, 0, -half }, { 0, 0, half } }, { radius = radius, joined = true })
  return b
end
local hinges = {}
local function bends(a, b, at, lower, upper)
  local joint = scene:joint { kind = "hinge", a = a, b = b, at = at, axis = { 0, 1, 0 }, contact = true }
  scene:constraint("joint_stops", { points = { joint:frame() }, lower = lower, upper = upper })
  hinges[#hinges + 1] = { joint = joint, lower = lower, upper = upper }
end

-- It stands on the edge and leans forwards.
local chest = limb(0, { -0.1, 0.95 }, { 0, 1.5 }, 0.12)
scene:joint { kind = "ball", a = limb(0, { 0.02, 1.55 }, { 0.06, 1.8 }, 0.1), b = chest, at = { 0.01, 0, 1.525 },
  contact = true }
for _, y in ipairs { -1, 1 } do
  local arm, forearm = limb(0.2 * y, { 0, 1.42 }, { -0.02, 1.14 }, 0.045), limb(0.2 * y, { -0.02, 1.1 }, { 0.04, 0.82 }, 0.04)
  local thigh, shin = limb(0.1 * y, { -0.1, 0.86 }, { -0.08, 0.5 }, 0.07), limb(0.1 * y, { -0.08, 0.46 }, { -0.12, 0.01 }, 0.05)
  scene:joint { kind = "ball", a = arm, b = chest, at = { 0, 0.19 * y, 1.43 }, contact = true }
  scene:joint { kind = "ball", a = thigh, b = chest, at = { -0.1, 0.1 * y, 0.9 }, contact = true }
  bends(forearm, arm, { -0.02, 0.2 * y, 1.12 }, -2.2, 0.1)
  bends(shin, thigh, { -0.08, 0.1 * y, 0.48 }, -0.1, 2.2)
end
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("contact", { thickness = 0.002, friction = mu })

scene:measure("beyond", function(s)
  local most = 0
  for _, h in ipairs(hinges) do most = math.max(most, h.lower - h.joint:angle(s), h.joint:angle(s) - h.upper) end
  return most
end, { unit = "rad" })
scene:measure("height", function(s) return chest:position(s)[3] end, { unit = "m" })
scene:output("frames", { width = 960, height = 720, legend = false, from = { 2.2, -4.2, 1.4 }, look_at = { 0.6, 0, 0.1 },
  particles = "off", springs = "off", tube = 0.001 })
return scene
