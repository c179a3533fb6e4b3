-- Scenes of contact whose motion is known in closed form, in pieces from impact to impact.
local families = {}

local G = 9.81

-- Distance, radius and time have their own scales: everything is drawn relative to `size`.
local function size_of(random) return random.log(1e-2, 1e2) end

local function add(out, format, ...) out[#out + 1] = format:format(...) end

local function vector(x, y, z) return ("{ %.17g, %.17g, %.17g }"):format(x, y, z) end

-- ---- a ball on a floor: Newton's restitution, countless impacts, rest ----

-- Height above the floor after t of a ball that begins at z > 0 with speed v.
local function bouncing_height(z, v, g, e, t)
  local fall = (v + math.sqrt(v * v + 2 * g * z)) / g
  if t < fall then return z + v * t - g * t * t / 2 end
  t, v = t - fall, e * (g * fall - v)
  if e >= 1 then t = t % (2 * v / g) end
  if e < 1 and t >= 2 * v / g / (1 - e) then return 0 end
  while t >= 2 * v / g do t, v = t - 2 * v / g, e * v end
  return v * t - g * t * t / 2
end

function families.bounce(random)
  local L, e, scene = size_of(random), random.chance(0.2) and 1 or random.uniform(0, 0.95), {}
  local z, v, side = L * random.uniform(0.1, 1), random.uniform(-1, 1) * math.sqrt(G * L), random.uniform(-1, 1) * math.sqrt(G * L)
  local lift = random.chance(0.3) and random.uniform(-0.3, 0.3) * math.sqrt(G * L) or 0 -- a floor that moves steadily
  local radius = random.chance(0.3) and 0.1 * L or 0
  add(scene, "scene:particle { position = %s, velocity = %s, mass = %.17g }", vector(0, 0, z + radius), vector(side, 0, v),
    random.log(1e-3, 1e3))
  add(scene, "scene:force('gravity', { g = { 0, 0, %.17g } })", -G)
  add(scene, "scene:corrector('obstacle', { restitution = %.17g, radius = %.17g, position = %s })", e, radius,
    lift == 0 and vector(0, 0, 0) or ("function(t) return { 0, 0, %.17g * t } end"):format(lift))
  return { scene = scene, n = 1, duration = math.sqrt(L / G) * random.uniform(1, 8), size = L, exact = function(t)
    return { side * t, 0, radius + lift * t + bouncing_height(z, v - lift, G, e, t) }
  end }
end

-- ---- a body on a slope: it slides, stops, and stays or slides back ----

function families.slope(random)
  local L, angle, mu, scene = size_of(random), random.uniform(0, 1.2), random.log(0.03, 2), {}
  local v, down = random.uniform(-2, 2) * math.sqrt(G * L), G * math.sin(angle)
  local brake = mu * G * math.cos(angle)
  local along, normal = { math.cos(angle), 0, -math.sin(angle) }, { math.sin(angle), 0, math.cos(angle) }
  add(scene, "scene:particle { position = { 0, 0, 0 }, velocity = %s, mass = %.17g }",
    vector(v * along[1], 0, v * along[3]), random.log(1e-3, 1e3))
  add(scene, "scene:force('gravity', { g = { 0, 0, %.17g } })", -G)
  add(scene, "scene:corrector('obstacle', { friction = %.17g, normal = %s })", mu, vector(table.unpack(normal)))
  local function way(t)
    if v == 0 and brake >= down then return 0 end
    local sign = v ~= 0 and v / math.abs(v) or 1
    local a = down - sign * brake
    local stop = a * sign < 0 and -v / a or math.huge
    if t <= stop then return v * t + a * t * t / 2 end
    local rest = v * stop + a * stop * stop / 2
    return rest + math.max(0, down - brake) * (t - stop) ^ 2 / 2
  end
  return { scene = scene, n = 1, duration = math.sqrt(L / G) * random.uniform(0.5, 6), size = L, exact = function(t)
    local s = way(t)
    return { s * along[1], 0, s * along[3] }
  end }
end

-- ---- a mass on a floor behind a spring whose end is drawn steadily: stick and slip ----

-- x of a mass with friction mu under a spring to p0 + V t; in pieces of sinusoids.
local function drawn(w, p0, V, limit, x, u, t)
  local p, direction = p0, u > 0 and 1 or u < 0 and -1 or 0
  while true do
    if direction == 0 then
      local pull = w * w * (p - x)
      if math.abs(pull) <= limit * (1 + 1e-12) then -- sticks up to the limit of friction
        local wait = V == 0 and math.huge or (limit / (w * w) * (V > 0 and 1 or -1) - (p - x)) / V
        if t <= wait then return x end
        t, p, direction = t - wait, p + V * wait, V > 0 and 1 or -1
      else
        direction = pull > 0 and 1 or -1
      end
    end
    local a, b = x - p + direction * limit / (w * w), (u - V) / w -- y = a cos + b sin about the moving balance
    local function at(s) return a * math.cos(w * s) + b * math.sin(w * s) end
    local function speed(s) return w * (b * math.cos(w * s) - a * math.sin(w * s)) + V end
    local size, stop = math.sqrt(a * a + b * b), math.huge
    if size * w > math.abs(V) * (1 + 1e-9) then -- -size w sin(w s - phase) = -V
      local phase, angle = math.atan(b, a), math.asin(V / (size * w))
      for k = -2, 3 do
        for _, root in ipairs { phase + angle, phase + math.pi - angle } do
          local s = (root + 2 * math.pi * k) / w
          if s > 1e-9 / w and s < stop and direction * speed(s + 1e-6 / w) < 0 then stop = s end
        end
      end
    end
    if t <= stop then return p + V * t - direction * limit / (w * w) + at(t) end
    x, p = p + V * stop - direction * limit / (w * w) + at(stop), p + V * stop
    u, t, direction = 0, t - stop, 0
  end
end

function families.stick_slip(random)
  local L, w, mu, scene = 1, random.log(1, 50), random.log(0.03, 1), {}
  local V = random.chance(0.2) and 0 or random.uniform(-1, 1) * random.log(0.01, 1) * w
  local limit = mu * G
  local rest, s0 = random.uniform(0.5, 3), random.uniform(-2, 2) * limit / (w * w)
  local u = random.chance(0.5) and 0 or random.uniform(-1, 1) * w * 0.2
  rest = rest + math.abs(s0) + 3 * limit / (w * w) + math.abs(u / w)
  local mass = random.log(1e-2, 1e2)
  if V < 0 then V = -V end -- the spring is not turned round
  add(scene, "local pin = scene:particle { position = %s, mass = 1 }", vector(rest + s0, 0, 0))
  add(scene, "scene:pin({ pin }, { path = function(t) return %.17g * t, 0, 0, %.17g, 0, 0 end })", V, V)
  add(scene, "scene:particle { position = { 0, 0, 0 }, velocity = %s, mass = %.17g }", vector(u, 0, 0), mass)
  add(scene, "scene:force('gravity', { g = { 0, 0, %.17g }, only = { 2 } })", -G)
  add(scene, "scene:force('springs', { edges = { { 1, 2 } }, k = %.17g, rest = %.17g })", mass * w * w, rest)
  add(scene, "scene:corrector('obstacle', { friction = %.17g })", mu)
  return { scene = scene, n = 2, duration = random.uniform(1, 30) / w, size = L, exact = function(t)
    return { rest + s0 + V * t, 0, 0, drawn(w, s0, V, limit, 0, u, t), 0, 0 }
  end }
end

-- ---- billiards: a ball in a box or outside of a sphere, without gravity ----

-- Position on a line of length b, between walls that leave e of the speed.
local function between(x, v, b, e, t)
  if v == 0 then return x end
  while true do
    local hit = v > 0 and (b - x) / v or -x / v
    if t <= hit or e == 0 then return t <= hit and x + v * t or (v > 0 and b or 0) end
    x, v, t = v > 0 and b or 0, -e * v, t - hit
  end
end

function families.billiard(random)
  local L, e, scene = size_of(random), random.chance(0.3) and 1 or random.uniform(0.3, 0.99), {}
  local x, v, box = {}, {}, {}
  for c = 1, 3 do
    box[c], v[c] = L * random.uniform(0.3, 1), L * random.uniform(-3, 3)
    x[c] = box[c] * random.uniform(0.1, 0.9)
  end
  add(scene, "scene:particle { position = %s, velocity = %s, mass = %.17g }", vector(x[1], x[2], x[3]),
    vector(v[1], v[2], v[3]), random.log(1e-3, 1e3))
  add(scene, "scene:corrector('obstacle', { shape = 'box', hollow = true, size = %s, position = %s, restitution = %.17g })",
    vector(box[1], box[2], box[3]), vector(box[1] / 2, box[2] / 2, box[3] / 2), e)
  return { scene = scene, n = 1, duration = random.uniform(0.5, 4), size = L, exact = function(t)
    local at = {}
    for c = 1, 3 do at[c] = between(x[c], v[c], box[c], e, t) end
    return at
  end }
end

function families.reflection(random)
  local r, e, scene = size_of(random), random.uniform(0, 1), {}
  local way, miss, speed = r * random.uniform(1.5, 4), r * random.uniform(0, 1.2), r * random.log(0.3, 30)
  add(scene, "scene:particle { position = %s, velocity = %s, mass = 1 }", vector(-way, miss, 0), vector(speed, 0, 0))
  add(scene, "scene:corrector('obstacle', { shape = 'sphere', size = %s, restitution = %.17g })", vector(2 * r, 2 * r, 2 * r), e)
  local reach = miss < r and math.sqrt(r * r - miss * miss) or 0
  return { scene = scene, n = 1, duration = way / speed * random.uniform(0.8, 2), size = r, exact = function(t)
    local hit = (way - reach) / speed
    if miss >= r or t <= hit then return { speed * t - way, miss, 0 } end
    local nx, ny = -reach / r, miss / r
    local push = (1 + e) * speed * nx
    return { -reach + (speed - push * nx) * (t - hit), miss - push * ny * (t - hit), 0 }
  end }
end

-- ---- a ball on a soft floor; spheres head on ----

-- Height above a floor of stiffness w^2 of a ball that fell from z > 0, and rises again and again.
local function soft_bounce(z, g, w, t)
  local fall, v, rest = math.sqrt(2 * z / g), math.sqrt(2 * g * z), g / (w * w)
  if t < fall then return z - g * t * t / 2 end
  local size, phase = math.sqrt(rest * rest + v * v / (w * w)), math.atan(v / w, rest) -- depth - rest = size sin
  local contact = (2 * (math.pi - math.atan(v / w, rest))) / w
  t = (t - fall) % (contact + 2 * fall)
  if t >= contact then return v * (t - contact) - g * (t - contact) ^ 2 / 2 end
  return -(rest - size * math.cos(w * t + phase)) + 0 * size
end

function families.soft_floor(random)
  local L, mass, scene = size_of(random), random.log(1e-3, 1e3), {}
  local z, w = L * random.uniform(0.1, 1), random.log(10, 3000) * math.sqrt(G / L)
  add(scene, "scene:particle { position = %s, mass = %.17g }", vector(0, 0, z), mass)
  add(scene, "scene:force('gravity', { g = { 0, 0, %.17g } })", -G)
  add(scene, "scene:force('penalty', { k = %.17g })", mass * w * w)
  return { scene = scene, n = 1, duration = math.sqrt(L / G) * random.uniform(1, 10), size = L,
    exact = function(t) return { 0, 0, soft_bounce(z, G, w, t) } end }
end

function families.spheres(random)
  local r, m1, m2, scene = size_of(random), random.log(0.1, 10), random.log(0.1, 10), {}
  local gap, speed = r * random.uniform(0.5, 3), r * random.log(0.3, 30)
  local mu = m1 * m2 / (m1 + m2)
  local w = speed / r * random.log(30, 1e4)
  local u1 = r * random.uniform(-3, 3)
  add(scene, "scene:particle { position = { 0, 0, 0 }, velocity = %s, mass = %.17g }", vector(u1 + speed, 0, 0), m1)
  add(scene, "scene:particle { position = %s, velocity = %s, mass = %.17g }", vector(2 * r + gap, 0, 0), vector(u1, 0, 0), m2)
  add(scene, "scene:force('soft_spheres', { radius = %.17g, stiffness = %.17g, restitution = 1, friction = 0 })", r, mu * w * w)
  return { scene = scene, n = 2, duration = gap / speed * random.uniform(1, 5), size = r, exact = function(t)
    local s, hit = 2 * r + gap - speed * t, gap / speed
    if t > hit then s = 2 * r - speed / w * math.sin(math.min(math.pi, w * (t - hit))) + speed * math.max(0, t - hit - math.pi / w) end
    local centre = (m2 * (2 * r + gap) + (m1 * (u1 + speed) + m2 * u1) * t) / (m1 + m2)
    return { centre - m2 / (m1 + m2) * s, 0, 0, centre + m1 / (m1 + m2) * s, 0, 0 }
  end }
end

-- A column of spheres on a wall, each as deep in the next one as what it carries makes it.
function families.stack(random)
  local r, mass, n, scene = size_of(random), random.log(1e-3, 1e3), 1 + random.below(4), {}
  local k, z, at = mass * G / r * random.log(100, 1e5), 0, {}
  for i = 1, n do
    z = i == 1 and r - n * mass * G / k or z + 2 * r - (n + 1 - i) * mass * G / k
    at[3 * i - 2], at[3 * i - 1], at[3 * i] = 0, 0, z
    add(scene, "scene:particle { position = %s, mass = %.17g }", vector(0, 0, z), mass)
  end
  add(scene, "scene:force('gravity', { g = { 0, 0, %.17g } })", -G)
  add(scene, "scene:force('soft_spheres', { radius = %.17g, stiffness = %.17g })", r, k)
  add(scene, "scene:force('soft_walls', { planes = { 0, 0, 1, 0 }, radius = %.17g, stiffness = %.17g })", r, k)
  return { scene = scene, n = n, duration = math.sqrt(r / G) * random.uniform(1, 20), size = r, exact = function() return at end }
end

return families
