-- The worst figure of a property over all cases, with the place where it was seen; and comparisons of arrays.
local worst = {}
worst.__index = worst

function worst.new() return setmetatable({ figure = 0, seen = 0 }, worst) end

-- Keeps the figure when it is the largest so far, or NaN.
function worst:take(figure, where)
  self.seen = self.seen + 1
  if self.figure == self.figure and (figure > self.figure or figure ~= figure) then self.figure, self.where = figure, where end
end

local axes = { "x", "y", "z" }
local function entry(k) return ("particle %d, %s"):format((k - 1) // 3 + 1, axes[(k - 1) % 3 + 1]) end

function worst.largest(a)
  local most = 0
  for k = 1, #a do
    local size = math.abs(a[k])
    if size > most or size ~= size then most = size end
  end
  return most
end

-- |a - b| over the largest of both, less what rounding explains (`noise`); infinite when a number is not finite. Beside
-- it a text with the worst entry.
function worst.difference(a, b, noise)
  local scale, off, at = 0, 0, nil
  for k = 1, #a do
    local x, y = a[k], b[k]
    if x ~= y and (x - x ~= 0 or y - y ~= 0) then return math.huge, ("%s: %g, expected %g"):format(entry(k), x, y) end
    if x - x == 0 then scale = math.max(scale, math.abs(x), math.abs(y)) end
    if x ~= y and math.abs(x - y) > off then off, at = math.abs(x - y), k end
  end
  off = off - (noise or 0)
  if off <= 0 or scale == 0 then return 0 end
  return off / scale, ("%s: %.6g, expected %.6g"):format(entry(at), a[at], b[at])
end

-- The same for square matrices of 3n rows.
function worst.matrix_difference(A, B, size, noise)
  local figure, text = worst.difference(A, B, noise)
  if not text then return figure end
  local off, at = -1, 1
  for k = 1, #A do
    local d = math.abs(A[k] - B[k])
    if d > off or d ~= d then off, at = d, k end
  end
  return figure, ("row %s, column %s: %.6g, expected %.6g"):format(entry((at - 1) // size + 1), entry((at - 1) % size + 1),
    A[at], B[at])
end

worst.entry = entry

return worst
