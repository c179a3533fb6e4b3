-- brick_wall: a wall of bricks laid dry on the floor z = 0, each row a quarter of a brick beside the one below, so that no
-- brick hangs over its support; along x, its middle plane at y = 0.
local brick_wall = {}

brick_wall.size = { 0.24, 0.115, 0.07 } -- m, of a brick
local gap, density = 0.01, 1800         -- m, between bricks of a row; kg/m^3

-- Lays the bricks, rigid bodies, and the floor; `thickness`: of their contact, m, which is left between rows. A handle with
-- `bricks`, and displaced(state): how many are out of their place by more than half of their height.
function brick_wall.build(scene, rows, columns, thickness)
  local size, wall, place = brick_wall.size, { bricks = {} }, {}
  for row = 1, rows do
    for column = 1, columns do
      local x = (column - (columns + 1) / 2 + (row % 2) / 4 - 0.125) * (size[1] + gap)
      place[#place + 1] = { x, 0, (row - 0.5) * (size[3] + thickness) }
      local brick = scene:rigid { shape = "box", size = size, density = density, position = place[#place] }
      brick:surface()
      wall.bricks[#wall.bricks + 1] = brick
    end
  end
  scene:body { shape = "box", size = { 6, 6, 0.2 }, position = { 0, 0, -0.1 } }
  function wall.displaced(state)
    local count = 0
    for k, brick in ipairs(wall.bricks) do
      local x, out = brick:position(state), 0
      for c = 1, 3 do out = out + (x[c] - place[k][c]) ^ 2 end
      if out > (size[3] / 2) ^ 2 then count = count + 1 end
    end
    return count
  end
  return wall
end

return brick_wall
