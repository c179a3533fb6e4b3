-- escapement.lua: a clock's deadbeat escapement (Graham). A wheel with pins, driven by a weight on a cord, goes on by one half of a pin's
-- distance at each swing, let through by the two pallets of an anchor that carries the pendulum; each pin that slides off a pallet gives
-- the pendulum what its hinge takes. The measures `period` and `free period` (of the pendulum by itself, at its amplitude) are in s,
-- `amplitude` is in rad, and `slips` counts the swings at which the wheel went on by more or less than half of a pin's distance.
local T = param("duration", 6, "s", { min = 0.1 })
local weight = param("weight", 0.03, "of what drives, kg", { min = 0 })
local start = param("start", 0.106, "from which the pendulum is let go, rad")
local lost = param("lost", 3e-3, "resistance in the pendulum's hinge, N m s/rad", { min = 0 })

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 1000, integrator = "leapfrog" }

-- Angles in rad, lengths in m. The pallets touch the circle of the pins where its tangents from the anchor's axis do, `half` off the top.
local g, R, pins, drum = 9.81, 0.1, 12, 0.01
local pitch = 2 * math.pi / pins
local half = 1.25 * pitch
local H = R / math.cos(half)
local pin, pallet = 0.002, 0.001 -- radii
local impulse = 0.37 * pitch                     -- of the wheel while a pin slides over the end of a pallet; 0.13 of the pitch it drops
local unlock, release = math.rad(1.2), math.rad(2.8) -- of the anchor, before and after the middle

-- A pin at the angle from the top, and its polar place about the anchor's axis: distance, and angle from below, positive to the left.
local function about_anchor(angle)
  local x, z = R * math.sin(angle), R * math.cos(angle) - H
  return math.sqrt(x ^ 2 + z ^ 2), math.atan(-x, -z)
end
local function place(distance, angle) return { -distance * math.sin(angle), 0, -distance * math.cos(angle) } end
local function from(p, q, radius, density)
  local x, z = q[1] - p[1], q[3] - p[3]
  return { shape = "capsule", radius = radius, length = math.sqrt(x ^ 2 + z ^ 2), density = density,
    position = { (p[1] + q[1]) / 2, 0, (p[3] + q[3]) / 2 }, orientation = { 0, math.atan(x, z), 0 } }
end

-- The middle line of a pallet, of capsules: an arc about the anchor's axis, on which a pin rests, and the slope over which it slides.
-- side 1: the left one, from outside to inside; -1: the right one, from inside to outside.
local function pallet_line(side)
  local far, near = pin + pallet, {}
  local held = about_anchor(-side * half - impulse / 2) -- distances of the pin's centre
  local free = about_anchor(-side * half + impulse / 2)
  local _, at = about_anchor(-side * half)
  local corner = held - side * far
  local beside = far / math.cos(math.atan((unlock + release) * held, math.abs(held - free)))
  local line, arc = {}, math.rad(14)
  for k = 4, 0, -1 do line[#line + 1] = place(corner, at + side * (unlock + beside / corner + arc * k / 4)) end
  near[1], near[2] = free, at + side * (beside / free - release)
  line[#line + 1] = place(near[1], near[2])
  return line
end

local parts, lines = {}, {}
for k, side in ipairs { 1, -1 } do
  lines[k] = pallet_line(side)
  for i = 1, #lines[k] - 1 do parts[#parts + 1] = from(lines[k][i], lines[k][i + 1], pallet, 2700) end
  parts[#parts + 1] = from({ 0, 0, 0 }, lines[k][1], 0.003, 2700)
end
local behind = 0.015 -- the pendulum swings behind the wheel, the wheel's rim behind the pallets
local rod = from({ 0, 0, 0 }, { 0, 0, -0.25 }, 0.003, 2700)
rod.position[2] = behind
parts[#parts + 1] = rod
parts[#parts + 1] = { shape = "cylinder", radius = 0.035, length = 0.012, density = 8500, position = { 0, behind, -0.25 },
  orientation = { math.pi / 2, 0, 0 } }
parts[#parts + 1] = { shape = "cylinder", radius = 0.006, length = behind, density = 2700, position = { 0, behind / 2, 0 },
  orientation = { math.pi / 2, 0, 0 } }
local anchor = scene:rigid { parts = parts, position = { 0, 0, H }, orientation = { 0, start, 0 }, group = "anchor" }
for k = 1, 2 do anchor:surface(lines[k], { radius = pallet, joined = true }) end

-- The first pin rests on the right pallet, 0.02 rad before its slope.
local spokes, places = {}, {}
local function on_rim(k)
  local a = half - impulse / 2 - 0.02 + k * pitch
  return { R * math.sin(a), 0, R * math.cos(a) }
end
for k = 1, pins do
  places[k] = on_rim(k)
  spokes[#spokes + 1] = { shape = "cylinder", radius = pin, length = 0.01, density = 2700, position = { places[k][1], 0.003, places[k][3] },
    orientation = { math.pi / 2, 0, 0 } }
  for _, bar in ipairs { from({ 0, 0, 0 }, places[k], 0.001, 1200), from(places[k], on_rim(k + 1), 0.001, 1200) } do
    bar.position[2] = 0.008
    spokes[#spokes + 1] = bar
  end
end
spokes[#spokes + 1] = { shape = "cylinder", radius = drum, length = 0.004, density = 1200, position = { 0, 0.008, 0 },
  orientation = { math.pi / 2, 0, 0 } }
local wheel = scene:rigid { parts = spokes, group = "wheel" }
wheel:surface(places, { radius = pin })

local arbor = scene:joint { kind = "hinge", a = wheel, at = { 0, 0, 0 }, axis = { 0, 1, 0 } }
local pivot = scene:joint { kind = "hinge", a = anchor, at = { 0, 0, H }, axis = { 0, 1, 0 } }
scene:force("gravity", { g = { 0, 0, -g } })
-- The weight is a moment on the wheel, as that of a cord about its drum is while the weight's own acceleration is small.
local moment = weight * g * drum
scene:force("joint_drives", { points = { arbor:frame() }, damping = 1e-3 * moment, speed = 1e4, most = moment })
scene:force("joint_drives", { points = { pivot:frame() }, damping = lost })
scene:corrector("contact", { thickness = 1e-4 })

-- Passages of the middle, by the cubic through angles and speeds of two frames.
local passages, previous, amplitude, slips, wheel_at = {}, nil, 0, 0, 0
local function passage(t, dt, a, u, b, w)
  local low, high = 0, 1
  for _ = 1, 50 do
    local z = (low + high) / 2
    local y = (1 + 2 * z) * (1 - z) ^ 2 * a + z * (1 - z) ^ 2 * dt * u + z ^ 2 * (3 - 2 * z) * b - z ^ 2 * (1 - z) * dt * w
    if (y > 0) == (a > 0) then low = z else high = z end
  end
  return t + low * dt
end
scene:on_frame(function(s)
  local a, u = pivot:angle(s) + start, pivot:speed(s)
  if previous and (a > 0) ~= (previous.a > 0) then
    passages[#passages + 1] = passage(previous.t, s.t - previous.t, previous.a, previous.u, a, u)
    local way = (arbor:angle(s) - wheel_at) % (2 * math.pi)
    wheel_at = arbor:angle(s)
    if #passages > 1 and math.abs(way - pitch / 2) > pitch / 4 then slips = slips + 1 end
  end
  if previous and (u > 0) ~= (previous.u > 0) then amplitude = math.max(math.abs(a), math.abs(previous.a)) end
  previous = { t = s.t, a = a, u = u }
end)
scene:measure("period", function()
  local n = #passages
  return n > 2 and 2 * (passages[n] - passages[n - 2 * ((n - 1) // 2)]) / (2 * ((n - 1) // 2)) or 0
end, { unit = "s" })
scene:measure("amplitude", function() return amplitude end, { unit = "rad" })
scene:measure("free period", function()
  local m, c, across = anchor.mass, anchor.center, 0
  for k = 1, 3 do across = across + anchor.inertia[k] * anchor.axes[k][2] ^ 2 end
  local d = math.sqrt(c[1] ^ 2 + c[3] ^ 2)
  return 2 * math.pi * math.sqrt((across + m * d ^ 2) / (m * g * d)) * (1 + amplitude ^ 2 / 16 + 11 * amplitude ^ 4 / 3072)
end, { unit = "s" })
scene:measure("slips", function() return slips end)
scene:measure("swings", function() return #passages end)
scene:output("frames", { width = 720, height = 720, legend = false, color = "group", particles = "off", springs = "off", tube = 0.001,
  from = { -0.25, -0.75, 0.1 }, look_at = { 0, 0, -0.01 } })
return scene
