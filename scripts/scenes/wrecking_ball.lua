-- wrecking_ball.lua: a ball on a chain of links, rigid bodies in ball joints, swings into a wall of bricks that friction alone holds. The
-- measure `displaced` counts the bricks that are out of their place by more than half of their height; `speed of the ball`, m/s.
local brick_wall = require("brick_wall")
local links = param("links", 6, "of the chain", { min = 1 })
local rows = param("rows", 4, "of bricks", { min = 1 })
local columns = param("columns", 2, "bricks in a row", { min = 1 })
local angle = param("angle", 1.2, "from which the ball is let go, rad", { min = 0 })
local T = param("duration", 0.9, "s", { min = 0.1 })
local mu = param("friction", 0.6, "")

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 1000, integrator = "leapfrog" }

local g, size, thickness, r = 9.81, brick_wall.size, 0.002, 0.1
local wall = brick_wall.build(scene, rows, columns, thickness)

-- The chain is straight, `angle` off the vertical; upright, the ball would touch the wall's middle.
local length, low = 0.8, 0.5 * rows * size[3]
local top, down = { 0, -r - size[2] / 2, low + length }, { 0, -math.sin(angle), -math.cos(angle) }
local function along(way) return { top[1], top[2] + way * down[2], top[3] + way * down[3] } end
local part, last = (length - r) / links, nil
for k = 1, links do
  local link = scene:rigid { shape = "capsule", radius = 0.008, length = part - 0.02, density = 7800, position = along((k - 0.5) * part),
    orientation = { angle, 0, 0 } }
  link:surface({ { 0, 0, 0.01 - part / 2 }, { 0, 0, part / 2 - 0.01 } }, { radius = 0.008, joined = true })
  scene:joint { kind = "ball", a = link, b = last, at = along((k - 1) * part) }
  last = link
end
local ball = scene:rigid { shape = "sphere", radius = r, density = 7800, position = along(length) }
ball:surface({ { 0, 0, 0 } }, { radius = r })
scene:joint { kind = "ball", a = ball, b = last, at = along(length - r) }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("contact", { thickness = thickness, friction = mu })

scene:measure("displaced", wall.displaced)
scene:measure("speed of the ball", function(s) return math.sqrt(2 * ball:energy(s) / ball.mass) end, { unit = "m/s" })
scene:output("frames", { width = 960, height = 540, legend = false, particles = "off",
  from = { 1.5, -1.3, 0.8 }, look_at = { 0, -0.15, 0.35 }, springs = "off", tube = 0.001 })
return scene
