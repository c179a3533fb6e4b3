-- bricks.lua: a wall of bricks, laid dry, that a ball hits. Friction alone holds the wall; what the ball takes from it falls. The
-- measure `displaced` counts the bricks that are out of their place by more than half of their height; `energy of the bricks`
-- and of the ball only falls, J.
local brick_wall = require("brick_wall")
local rows = param("rows", 4, "of bricks", { min = 1 })
local columns = param("columns", 3, "bricks in a row", { min = 1 })
local speed = param("speed", 6, "of the ball, m/s", { min = 0 })
local T = param("duration", 0.8, "s", { min = 0.1 })
local mu = param("friction", 0.6, "")

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 500, integrator = "leapfrog" }

local g, size, thickness = 9.81, brick_wall.size, 0.002
local wall = brick_wall.build(scene, rows, columns, thickness)
local ball = scene:rigid { shape = "sphere", radius = 0.1, density = 3000,
  position = { 0.02, -0.5, math.max(0.11, 0.6 * rows * size[3]) }, velocity = { 0, speed, 0 } }
ball:surface()
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("contact", { thickness = thickness, friction = mu })

scene:measure("displaced", wall.displaced)
scene:measure("energy of the bricks", function(s)
  local E = ball:energy(s) + ball.mass * g * ball:position(s)[3]
  for _, b in ipairs(wall.bricks) do E = E + b:energy(s) + b.mass * g * b:position(s)[3] end
  return E
end, { unit = "J" })
scene:output("frames", { width = 960, height = 540, legend = false, from = { 1.1, -1.5, 0.8 }, look_at = { 0, 0.15, 0.12 } })
return scene
