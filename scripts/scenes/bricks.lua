-- bricks.lua: a wall of bricks, laid dry, that a ball hits. Friction alone holds the wall; what the ball takes from it falls. The
-- measure `displaced` counts the bricks that are out of their place by more than half of their height; `energy of the bricks`
-- and of the ball only falls, J.
local rows = param("rows", 4, "of bricks", { min = 1 })
local columns = param("columns", 3, "bricks in a row", { min = 1 })
local speed = param("speed", 6, "of the ball, m/s", { min = 0 })
local T = param("duration", 0.8, "s", { min = 0.1 })
local mu = param("friction", 0.6, "")

local scene = hooke.scene { duration = T, fps = 50, dt = 1 / 500, integrator = "leapfrog" }

local g, size, thickness, gap = 9.81, { 0.24, 0.115, 0.07 }, 0.002, 0.01
local bricks, place = {}, {}
for row = 1, rows do
  for column = 1, columns do
    local x = (column - (columns + 1) / 2 + (row % 2) / 4 - 0.125) * (size[1] + gap)
    place[#place + 1] = { x, 0, (row - 0.5) * (size[3] + thickness) }
    bricks[#bricks + 1] = scene:rigid { shape = "box", size = size, density = 1800, position = place[#place] }
    bricks[#bricks]:surface()
  end
end
local ball = scene:rigid { shape = "sphere", radius = 0.1, density = 3000,
  position = { 0.02, -0.5, math.max(0.11, 0.6 * rows * size[3]) }, velocity = { 0, speed, 0 } }
ball:surface()
scene:body { shape = "box", size = { 6, 6, 0.2 }, position = { 0, 0, -0.1 } }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("contact", { thickness = thickness, friction = mu })

scene:measure("displaced", function(s)
  local count = 0
  for k, b in ipairs(bricks) do
    local x, out = b:position(s), 0
    for c = 1, 3 do out = out + (x[c] - place[k][c]) ^ 2 end
    if out > (size[3] / 2) ^ 2 then count = count + 1 end
  end
  return count
end)
scene:measure("energy of the bricks", function(s)
  local E = ball:energy(s) + ball.mass * g * ball:position(s)[3]
  for _, b in ipairs(bricks) do E = E + b:energy(s) + b.mass * g * b:position(s)[3] end
  return E
end)
scene:output("frames", { width = 960, height = 540, legend = false, from = { 1.1, -1.5, 0.8 }, look_at = { 0, 0.15, 0.12 } })
return scene
