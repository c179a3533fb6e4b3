-- cradle.lua: Newton's cradle. Balls hang in a row, a tenth of a millimetre apart, each by its centre on two bars, which keep it in the
-- plane of the row; `lifted` of them are let go at `angle`, and as many leave at the other end. Each impact is between two balls,
-- which exchange their speeds; with `restitution` below 1 the row begins to swing as a whole. The measures are angles of the
-- first and the last ball and of that `next` to the last, rad, outwards above 0, and the `energy of the balls`, J, kept for 1.
local n = param("n", 5, "balls", { min = 2 })
local lifted = param("lifted", 1, "balls that are let go", { min = 1 })
local angle = param("angle", 0.6, "rad", { min = 0.01, max = 1.4 })
local e = param("restitution", 1, "1: nothing is lost", { min = 0, max = 1 })
local T = param("duration", 3, "s", { min = 0.1 })

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 1000, integrator = "leapfrog" }

local g, r, length, gap, spread = 9.81, 0.025, 0.3, 1e-4, 0.1
local drop = math.sqrt(length ^ 2 - spread ^ 2) -- from the bars' line of pins to the centre
local balls, bars, top = {}, {}, {}
for k = 1, n do
  local x, turned = (2 * r + gap) * (k - 1), k <= lifted and angle or 0
  balls[k] = scene:rigid { shape = "sphere", radius = r, density = 7800,
    position = { x - drop * math.sin(turned), 0, -drop * math.cos(turned) } }
  balls[k]:surface({ { 0, 0, 0 } }, { radius = r })
  local center = balls[k]:point { 0, 0, 0 }
  top[k] = x
  for _, side in ipairs { -spread, spread } do
    local id = scene:particle { position = { x, side, 0 }, mass = 1 }
    scene:pin { id }
    bars[#bars + 1] = { id, center }
  end
end
scene:constraint("bars", { edges = bars })
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("contact", { restitution = e })

local function outwards(s, k)
  local x = balls[k]:position(s)
  return math.atan(k == 1 and top[k] - x[1] or x[1] - top[k], -x[3])
end
scene:measure("angle of the first", function(s) return outwards(s, 1) end, { unit = "rad" })
scene:measure("angle of the last", function(s) return outwards(s, n) end, { unit = "rad" })
scene:measure("angle of the next", function(s) return outwards(s, n - 1) end, { unit = "rad" })
scene:measure("energy of the balls", function(s)
  local E = 0
  for k = 1, n do E = E + balls[k]:energy(s) + balls[k].mass * g * (balls[k]:position(s)[3] + drop) end
  return E
end, { unit = "J" })
scene:output("frames", { width = 960, height = 720, legend = false, from = { 0.1, -0.85, -0.05 }, look_at = { 0.1, 0, -0.17 },
  ground_height = -0.36, tube = 0.001, radius = 0.002 })
return scene
