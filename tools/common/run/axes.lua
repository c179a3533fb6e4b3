-- What a diagram's axes show: ranges that hold every point, ticks of logarithmic ones, the staircase of a front, labels
-- beside each other. Numbers only: plot.lua draws.
local axes = {}

local margin = 0.04 -- of the axis, beyond the outermost points

local function good(x, log) return type(x) == "number" and x == x and math.abs(x) < math.huge and (not log or x > 0) end

-- The smallest and the largest of the numbers that can be drawn; nil: there is none.
function axes.extent(values, log)
  local low, high
  for _, x in ipairs(values) do
    if good(x, log) then low, high = math.min(low or x, x), math.max(high or x, x) end
  end
  return low, high
end

-- How many of the finite numbers have no logarithm.
function axes.without_logarithm(values)
  local count = 0
  for _, x in ipairs(values) do
    if good(x) and x <= 0 then count = count + 1 end
  end
  return count
end

-- What the axis gives as `min` and `max`, moved outwards where a point would be outside, and by a margin further, so that
-- its mark is whole. A side that is not given stays gnuplot's (nil), which shows all points. A range that the user fixed is
-- kept; the third value is then the number of points outside of it.
function axes.range(axis, values)
  local low, high = axes.extent(values, axis.log)
  local min, max, outside = axis.min, axis.max, 0
  if axis.fixed then
    for _, x in ipairs(values) do
      if good(x, axis.log) and (x < (min or x) or x > (max or x)) then outside = outside + 1 end
    end
    return min, max, outside
  end
  if not low then return min, max, 0 end
  local from, to = math.min(min or low, low), math.max(max or high, high)
  local room = axis.log and (to / from) ^ margin or margin * (to - from)
  if min and low < min then min = axis.log and low / room or low - room end
  if max and high > max then max = axis.log and high * room or high + room end
  return min, max, 0
end

-- Multiples of powers of ten from low to high.
local function multiples(low, high, factors)
  local list = {}
  for power = math.floor(math.log(low, 10)), math.ceil(math.log(high, 10)) do
    for _, factor in ipairs(factors) do
      local x = factor * 10.0 ^ power
      if x >= low * (1 - 1e-9) and x <= high * (1 + 1e-9) then list[#list + 1] = x end
    end
  end
  return list
end

-- Ticks of a logarithmic axis from low to high: powers of ten, and where fewer than two of these are inside, round
-- multiples of them, or else five equal ratios.
function axes.log_ticks(low, high)
  for _, factors in ipairs { { 1 }, { 1, 2, 5 }, { 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8 } } do
    local list = multiples(low, high, factors)
    if #list >= 2 then return list end
  end
  local list = {}
  for k = 0, 4 do list[k + 1] = low * (high / low) ^ (k / 4) end
  return list
end

-- What can really be had of points { error, cost }, none of which is better in both than another: with an error allowed,
-- the cost of the cheapest point below it. So a staircase, from the top above the most accurate point to the right edge.
function axes.staircase(front, right, top)
  local steps, points = {}, table.move(front, 1, #front, 1, {})
  table.sort(points, function(a, b) return a[1] < b[1] end)
  for k, p in ipairs(points) do
    steps[#steps + 1] = { p[1], k == 1 and top or points[k - 1][2] }
    steps[#steps + 1] = { p[1], p[2] }
  end
  if #points > 0 then steps[#steps + 1] = { right, points[#points][2] } end
  return steps
end

-- Moves heights (0 to 1) apart to at least this gap, in their order and as little as that takes: neighbours that are too
-- near become a block around their mean.
function axes.spread(heights, gap)
  local order, blocks, placed = {}, {}, {}
  for k in ipairs(heights) do order[k] = k end
  table.sort(order, function(a, b) return heights[a] < heights[b] or (heights[a] == heights[b] and a < b) end)
  for _, k in ipairs(order) do
    local block = { members = { k }, sum = heights[k] }
    local last = blocks[#blocks]
    local function reach(b) return b.sum / #b.members, (#b.members - 1) * gap / 2 end
    while last do
      local below, half = reach(last)
      local here, own = reach(block)
      if here - own - (below + half) >= gap then break end
      block = { members = table.move(block.members, 1, #block.members, #last.members + 1, last.members),
        sum = last.sum + block.sum }
      blocks[#blocks] = nil
      last = blocks[#blocks]
    end
    blocks[#blocks + 1] = block
  end
  for _, block in ipairs(blocks) do
    local lowest = block.sum / #block.members - (#block.members - 1) * gap / 2
    for j, k in ipairs(block.members) do placed[k] = lowest + (j - 1) * gap end
  end
  return placed
end

return axes
