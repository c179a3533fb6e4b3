-- The integral of the square of functions that are linear between knots, as a square of numbers: u^T W u = |y|^2 with
-- W = L L^T and y = L^T u. Over an interval of length d between the values a and b it is d (a^2 + a b + b^2)/3, so that W has
-- a diagonal and one number beside it.
local cost = {}

-- The factor L of one control: its diagonal and what is below it.
local function factor(count, interval)
  local diagonal, below = {}, {}
  for k = 1, count do
    local inner = k > 1 and k < count
    local entry = interval * (inner and 2 or 1) / 3
    if k > 1 then
      below[k] = interval / 6 / diagonal[k - 1]
      entry = entry - below[k] ^ 2
    end
    diagonal[k] = math.sqrt(entry)
  end
  return diagonal, below
end

-- Of all controls, { duration =, values = }, one after the other.
function cost.of(controls)
  local self, at = { diagonal = {}, below = {} }, 0
  for _, control in ipairs(controls) do
    local count = #control.values
    local diagonal, below = factor(count, control.duration / (count - 1))
    for k = 1, count do self.diagonal[at + k], self.below[at + k] = diagonal[k], below[k] or 0 end
    at = at + count
  end
  return setmetatable(self, { __index = cost })
end

-- W of all controls, by columns.
function cost.matrix(controls)
  local W, at, n = {}, 0, 0
  for _, control in ipairs(controls) do n = n + #control.values end
  for i = 1, n do
    W[i] = {}
    for k = 1, n do W[i][k] = 0 end
  end
  for _, control in ipairs(controls) do
    local count = #control.values
    for k = at + 1, at + count - 1 do
      local part = control.duration / (count - 1) / 6
      W[k][k], W[k + 1][k + 1] = W[k][k] + 2 * part, W[k + 1][k + 1] + 2 * part
      W[k][k + 1], W[k + 1][k] = part, part
    end
    at = at + count
  end
  return W
end

-- y = L^T u
function cost:weighted(u)
  local y = {}
  for k = 1, #u do y[k] = self.diagonal[k] * u[k] + (u[k + 1] and self.below[k + 1] * u[k + 1] or 0) end
  return y
end

-- u with L^T u = y
function cost:values(y)
  local u = {}
  for k = #y, 1, -1 do
    u[k] = (y[k] - (u[k + 1] and self.below[k + 1] * u[k + 1] or 0)) / self.diagonal[k]
  end
  return u
end

-- The derivative by y of what has the derivative `slope` by u: L^-1 slope.
function cost:slope(slope)
  local s = {}
  for k = 1, #slope do s[k] = (slope[k] - (k > 1 and self.below[k] * s[k - 1] or 0)) / self.diagonal[k] end
  return s
end

-- The derivatives of u[k] by y, as they are at every y: a column of L^-1.
function cost:row(k)
  local unit = {}
  for j = 1, #self.diagonal do unit[j] = j == k and 1 or 0 end
  return self:slope(unit)
end

-- The bounds of the values of controls, { min =, max = }, for common/optimise/sqp.lua; nil: there are none.
function cost:bounds(controls)
  local low, high, any, rows = {}, {}, false, {}
  for _, control in ipairs(controls) do
    local min, max = control.min or -math.huge, control.max or math.huge
    any = any or min > -math.huge or max < math.huge
    for _ = 1, #control.values do low[#low + 1], high[#high + 1] = min, max end
  end
  if not any then return nil end
  local function clip(y)
    local u = self:values(y)
    for k = 1, #u do u[k] = math.min(math.max(u[k], low[k]), high[k]) end
    return self:weighted(u)
  end
  local function row(k)
    rows[k] = rows[k] or self:row(k)
    return table.move(rows[k], 1, #rows[k], 1, {})
  end
  return { low = low, high = high, clip = clip, row = row, values = function(y) return self:values(y) end }
end

return cost
