-- fountain.lua: a jet of water and a ring of twelve around it, as drops that the air slows down. The drops of a jet are
-- born evenly in time, also within a step, so that it has no stripes however long the steps are. Colours: speed.
local rate = param("rate", 12000, "drops of all jets per second", { min = 1, max = 1e6 })

local scene = hooke.scene { duration = 4, fps = 60, dt = 1 / 240, integrator = "leapfrog" }

local g, drag = 9.81, 0.25 -- m/s^2, 1/s
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("drag", { rate = drag })

-- The time until a drop that leaves with w m/s upwards is down again, by Newton's method; without drag it is 2 w/g.
local function flight(w)
  local t = 2 * w / g
  for _ = 1, 20 do
    local z = (w + g / drag) * (1 - math.exp(-drag * t)) / drag - g / drag * t
    t = t - z / ((w + g / drag) * math.exp(-drag * t) - g / drag)
  end
  return t
end

local function jet(share, place, slope, speed, spread)
  local up = speed / math.sqrt(1 + slope * slope)
  local across = math.sqrt(place[1] ^ 2 + place[2] ^ 2)
  local x, y = 0, 0
  if across > 0 then x, y = place[1] / across * slope, place[2] / across * slope end
  scene:source("emitter", { rate = share * rate, shape = "disc", extent = 0.03, position = place, direction = { x, y, 1 },
    cone = spread, speed = speed, speed_spread = 0.04, lifetime = flight(up), mass = 1e-4, group = "water" })
end

jet(0.28, { 0, 0, 0 }, 0, 8, 2.5)
for k = 1, 12 do
  local a = math.pi * (k + 0.5) / 6
  jet(0.06, { 0.5 * math.cos(a), 0.5 * math.sin(a), 0 }, 0.35, 5.2, 1.2)
end

-- Without the spreads the middle jet would rise to (w - g/drag log(1 + drag w/g))/drag = 2.9 m.
scene:measure("top", function(s)
  local top = 0
  for _, id in ipairs(s:ids()) do top = math.max(top, s:position(id)[3]) end
  return top
end, { unit = "m" })
scene:measure("drops", function(s) return s.n end)
scene:output("frames", { width = 1280, height = 720, color = "speed", radius = 0.014, from = { 0.4, -8.2, 3.2 },
  look_at = { 0, 0, 1.25 }, ground_height = -0.01 })
return scene
