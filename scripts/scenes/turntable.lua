-- turntable.lua: balls roll on a table that turns, each round a circle of its own at 2/7 of the table's rate, about a place that
-- its start determines. `rate` is that of the first one, in parts of 2/7 of the table's; `off` how far it is from its circle, m.
local T = param("duration", 11, "s", { min = 0.1 })
local W = param("rate", 2, "rad/s")
local mu = param("friction", 0.5, "")

local scene = hooke.scene { duration = T, fps = 25, dt = 1 / 1000, integrator = "leapfrog" }

local g, r = 9.81, 0.09
local Q = 2 / 7 * W
local balls = {}
-- v and spin let a ball roll at its start: v + spin x (-r z) is the speed of the table there.
local function add(x, y, vx, vy)
  local ball = scene:rigid { shape = "sphere", radius = r, mass = 0.5, position = { x, y, r }, velocity = { vx, vy, 0 },
    spin = { (W * x - vy) / r, (vx + W * y) / r, 0 } }
  ball:surface { { 0, 0, 0 } }
  balls[#balls + 1] = { body = ball, center = { x - vy / Q, y + vx / Q } }
end
add(0.7, 0, 0, 0.15)
add(-0.5, 0.35, 0.2, 0.1)
add(0, -0.65, 0, 0)

scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("obstacle", { shape = "cylinder", size = { 2.4, 2.4, 0.1 }, position = { 0, 0, -0.05 }, friction = mu, radius = r,
  rotation = function(t) return 0, 0, W * t end })

local first = balls[1]
local function angle(s)
  local x = first.body:position(s)
  return math.atan(x[2] - first.center[2], x[1] - first.center[1])
end
local last, round, when = 0, 0, 0
scene:on_frame(function(s)
  local a = angle(s)
  round, last, when = round + (a - last + math.pi) % (2 * math.pi) - math.pi, a, s.t
end)
scene:measure("rate", function() return when > 0 and round / when / Q or 1 end)
scene:measure("off", function(s)
  local x = first.body:position(s)
  return math.sqrt((x[1] - first.center[1]) ^ 2 + (x[2] - first.center[2]) ^ 2) - 0.15 / Q
end, { unit = "m" })
scene:output("frames", { width = 960, height = 720, legend = false, from = { 0.4, -3.6, 2.6 }, look_at = { 0, 0, -0.1 },
  ground_height = -0.4 })
return scene
