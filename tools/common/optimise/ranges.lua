-- Goals that leave a measure a range, in place of a value: bounds of a quadratic program behind those of the controls. Of all goals those
-- with a value stand first.
local ranges = {}
ranges.__index = ranges

-- What is missing of a goal where its measure is x: 0 within its range.
function ranges.missed(goal, x)
  if goal.value then return x - goal.value end
  if goal.min and x < goal.min then return x - goal.min end
  if goal.max and x > goal.max then return x - goal.max end
  return 0
end

-- In words: "= 1", ">= 0.2" or "in [0, 1]".
function ranges.words(goal)
  if goal.value then return ("= %.9g"):format(goal.value) end
  if goal.min and goal.max then return ("in [%.9g, %.9g]"):format(goal.min, goal.max) end
  return goal.min and (">= %.9g"):format(goal.min) or ("<= %.9g"):format(goal.max)
end

-- Of a list of goals, those with a value first; scale: of every number (nil: 1).
function ranges.of(goals, scale)
  local self = { equal = #goals, low = {}, high = {} }
  for g, goal in ipairs(goals) do
    if not goal.value then
      local part = scale and scale[g] or 1
      self.low[#self.low + 1], self.high[#self.high + 1] = (goal.min or -math.huge) * part, (goal.max or math.huge) * part
    end
  end
  self.equal = #goals - #self.low
  return setmetatable(self, ranges)
end

-- How far c, the values of all goals (of those with a value what is missing), is beyond each range.
function ranges:beyond(c)
  local list = {}
  for r, low in ipairs(self.low) do
    local x = c[self.equal + r]
    list[r] = x < low and x - low or x > self.high[r] and x - self.high[r] or 0
  end
  return list
end

-- What is missing of all goals together.
function ranges:missing(c)
  local sum = 0
  for i = 1, self.equal do sum = sum + math.abs(c[i]) end
  for _, x in ipairs(self:beyond(c)) do sum = sum + math.abs(x) end
  return sum
end

-- The goal of which most is missing.
function ranges:worst(c)
  local off, row = table.move(c, 1, self.equal, 1, {}), 1
  for r, x in ipairs(self:beyond(c)) do off[self.equal + r] = x end
  for i = 2, #off do row = math.abs(off[i]) > math.abs(off[row]) and i or row end
  return row
end

-- The bounds of common/optimise/quadratic.lua: those of the controls, nil: none, at their values `at`, and then those of the ranges, where
-- measures have the values of c; only a part is asked for of what is beyond them. change(r, p): of that measure by p; row(r): its row.
function ranges:bounds(bounds, at, c, part, change, row)
  if not bounds and #self.low == 0 then return nil end
  local n = bounds and #at or 0
  local function behind(list) return table.move(list, 1, n, 1, {}) end
  local all = { at = behind(at), low = behind(bounds and bounds.low or {}), high = behind(bounds and bounds.high or {}) }
  for r, low in ipairs(self.low) do
    local x, high = c[self.equal + r], self.high[r]
    all.at[n + r] = x
    all.low[n + r], all.high[n + r] = x < low and x + part * (low - x) or low, x > high and x + part * (high - x) or high
  end
  function all.values(p)
    local list = bounds and behind(bounds.values(p)) or {}
    for r = 1, #self.low do list[n + r] = change(r, p) end
    return list
  end
  function all.row(k) return k <= n and bounds.row(k) or row(k - n) end
  return all
end

-- The multipliers of all goals, of those of a step of the quadratic program with n bounds of controls.
function ranges:multipliers(step, n)
  local list = table.move(step.multipliers, 1, self.equal, 1, {})
  for r = 1, #self.low do list[self.equal + r] = step.prices[n + r] or 0 end
  return list
end

-- What is beyond each bound of quadratic.solve, by its number, where n are of controls: what a correction takes back.
function ranges:taken_back(c, n)
  local list = {}
  for r, x in ipairs(self:beyond(c)) do list[n + r] = x end
  return list
end

return ranges
