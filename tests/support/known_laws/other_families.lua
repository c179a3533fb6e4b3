-- Scenes with known motion: cables that come taut, very many turns, fountains, cooling and heated bodies.
local families = {}

local G = 9.81

local function add(out, format, ...) out[#out + 1] = format:format(...) end

local function vector(x, y, z) return ("{ %.17g, %.17g, %.17g }"):format(x, y, z) end

-- The angle after t from a, w: a'' = -rate sin a; Taylor's series of order 20 by the products of sine and cosine.
local function pendulum(rate, a, w, t)
  local order, steps = 20, math.max(1, math.ceil(t * math.sqrt(rate + w * w) * 4))
  local h = t / steps
  for _ = 1, steps do
    local x, s, c = { [0] = a, w }, { [0] = math.sin(a) }, { [0] = math.cos(a) }
    for k = 0, order - 2 do
      if k > 0 then
        s[k], c[k] = 0, 0
        for j = 1, k do
          s[k] = s[k] + j * x[j] * c[k - j] / k
          c[k] = c[k] - j * x[j] * s[k - j] / k
        end
      end
      x[k + 2] = -rate * s[k] / ((k + 1) * (k + 2))
    end
    a, w = 0, 0
    for k = order, 0, -1 do a = a * h + x[k] end
    for k = order, 1, -1 do w = w * h + k * x[k] end
  end
  return a, w
end

-- A mass flies or falls until its cable is taut, and swings from there without its speed along the cable.
function families.cable(random)
  local R, scene, free = random.log(0.01, 100), {}, random.chance(0.4)
  local g = free and 0 or G
  local way, angle = R * random.uniform(0, 0.7), random.uniform(-0.9, 0.9) -- of the start from the pin, from downwards
  local x, z = way * math.sin(angle), -way * math.cos(angle)
  local speed = random.uniform(free and 0.3 or 0, 1.2) * math.sqrt(G * R)
  local u, v = speed * math.sin(random.uniform(-1, 1)), -speed * (free and 1 or random.uniform(0, 1))
  local function place(t) return x + u * t, z + v * t - g * t * t / 2 end
  local step = math.sqrt(R / G) / 1000 -- the first crossing of |x(t)| = R
  local k = 0
  while true do
    local px, pz = place((k + 1) * step)
    if px * px + pz * pz > R * R then break end
    k = k + 1
    if k > 1e6 then return families.cable(random) end
  end
  local low, high = k * step, (k + 1) * step
  for _ = 1, 60 do
    local t = (low + high) / 2
    local px, pz = place(t)
    if px * px + pz * pz > R * R then high = t else low = t end
  end
  local hit, hx, hz = high, place(high)
  local w = ((u * -hz) + (v - g * hit) * hx) / (R * R)
  local a = math.atan(hx, -hz)
  -- Taut for ever: it turns without gravity, or does not rise above the pin.
  if g > 0 and w * w * R / 2 / g >= math.cos(a) - 1e-3 then return families.cable(random) end
  add(scene, "scene:particle { position = { 0, 0, 0 }, mass = 1 }")
  add(scene, "scene:particle { position = %s, velocity = %s, mass = %.17g }", vector(x, 0, z), vector(u, 0, v), random.log(1e-3, 1e3))
  add(scene, "scene:pin { 1 }")
  if g > 0 then add(scene, "scene:force('gravity', { g = { 0, 0, %.17g } })", -g) end
  add(scene, "scene:constraint('cables', { edges = { { 1, 2 } }, length = %.17g })", R)
  return { scene = scene, n = 2, duration = hit + math.sqrt(R / G) * random.uniform(0, 10), size = R, exact = function(t)
    if t <= hit then
      local px, pz = place(t)
      return { 0, 0, 0, px, 0, pz }
    end
    local b = g > 0 and pendulum(g / R, a, w, t - hit) or a + w * (t - hit)
    return { 0, 0, 0, R * math.sin(b), 0, -R * math.cos(b) }
  end }
end

-- Up to `most` periods of a spring, or of a circle about a star.
local function many_turns(random, most)
  local w, turns, scene, kepler = random.log(1e-3, 1e3), random.log(300, most), {}, random.chance(0.5)
  local start = random.uniform(0, 6)
  add(scene, "scene:particle { position = %s, velocity = %s, mass = %.17g }", vector(math.cos(start), math.sin(start), 0),
    vector(-w * math.sin(start), w * math.cos(start), 0), random.log(1e-9, 1e9))
  add(scene, "scene:force('central', { strength = %.17g, power = %d })", w * w, kepler and -2 or 1)
  -- The doubles of the start are not on the circle: by 1e-16, of which a Kepler orbit makes 3/2 a turn.
  return { scene = scene, n = 1, duration = 2 * math.pi * turns / w, frames = 10 + random.below(30), size = 1, slow = true,
    exact = function(t) return { math.cos(start + w * t), math.sin(start + w * t), 0 } end }
end

function families.many_turns(random) return many_turns(random, 5e3) end

function families.very_many_turns(random) return many_turns(random, 1e6) end

-- Births at a rate; each flies as a thrown stone does, with drag or without.
function families.fountain(random)
  local scene, speed, drag = {}, random.uniform(0.5, 5), random.chance(0.5) and random.log(0.1, 10) or 0
  local duration = random.uniform(0.3, 2)
  local rate = random.uniform(2, 8) / duration
  local from = random.uniform(0, 0.3) * duration
  local n = math.floor((duration - from) * rate) + 1
  add(scene, "scene:source('emitter', { rate = %.17g, from = %.17g, speed = %.17g, mass = 0.1 })", rate, from, speed)
  add(scene, "scene:force('gravity', { g = { 0, 0, %.17g } })", -G)
  if drag > 0 then add(scene, "scene:force('drag', { rate = %.17g })", drag) end
  return { scene = scene, n = n, births = true, duration = duration, size = 1, exact = function(t)
    local at = {}
    for k = 0, n - 1 do
      local u, z = t - from - k / rate, 0
      if math.abs(u) < 1e-9 then return nil end -- at a frame: born or not
      if u > 0 then
        local last = drag > 0 and -G / drag
        z = last and last * u - (speed - last) * (math.exp(-drag * u) - 1) / drag or speed * u - G * u * u / 2
      end
      at[3 * k + 1], at[3 * k + 2], at[3 * k + 3] = 0, 0, z
    end
    return at
  end }
end

return families
