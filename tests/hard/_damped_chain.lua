-- A chain with one end free whose fastest mode is damped with the ratio given: damping_ratio_1, _3 and _10.
-- The bound: the slow mode, 0.1 m at 5.8 1/s, and the middle one, 0.02 m at 42 1/s, are there to be seen; order 2 at
-- h = 1/240 s leaves h^2 w^3 T/24 = 7e-5 of the first and, damped as it is, less than 3e-2 of the second; a thousandth
-- of a metre is far above what order 2 leaves, and what order 1 leaves is not.
local n, k, m = 8, 100, 0.1
local size = { 0.1, 0, 0, 0.02, 0, 0, 0, 0.01 } -- of the modes

local function frequency(p) return 2 * math.sqrt(k / m) * math.sin((2 * p - 1) * math.pi / (2 * (2 * n + 1))) end

local function swing(p, t, damping) -- from 1, at rest; damping, N s/m: a mode has the rate damping w^2/k
  local w = frequency(p)
  local g = damping * w * w / k / 2
  local d = math.sqrt(math.abs(g * g - w * w))
  if d < 1e-6 * w then return (1 + g * t) * math.exp(-g * t) end
  if g < w then return math.exp(-g * t) * (math.cos(d * t) + g / d * math.sin(d * t)) end
  local slow = w * w / (g + d)
  return ((g + d) * math.exp(-slow * t) - slow * math.exp(-(g + d) * t)) / (2 * d)
end

local function positions(t, damping)
  local x = { 0, 0, 0 }
  for i = 1, n do
    local u = i
    for p, a in ipairs(size) do u = u + a * swing(p, t, damping) * math.sin((2 * p - 1) * math.pi * i / (2 * n + 1)) end
    x[3 * i + 1], x[3 * i + 2], x[3 * i + 3] = u, 0, 0
  end
  return x
end

return function(ratio)
  local scene = hooke.scene { duration = 0.5, fps = 240, accuracy = 1e-3 }
  local damping = 2 * ratio * k / frequency(n)
  local start, places, edges = positions(0, damping), {}, {}
  for i = 0, n do
    places[i + 1] = { start[3 * i + 1], 0, 0 }
    if i > 0 then edges[i] = { i, i + 1 } end
  end
  scene:particles { positions = places, mass = m }
  scene:pin { 1 }
  scene:force("springs", { edges = edges, k = k, damping = damping, rest = 1 })
  scene:exact(function(t) return table.unpack(positions(t, damping)) end)
  return scene
end
