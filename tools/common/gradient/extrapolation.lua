-- One-sided derivatives and limits of a function that is known at p and at distances h, h/2, h/4, ... on one side of it: of the
-- differences (f(p + h) - f(p))/h a series in h is taken to h = 0 by the table of Neville (Ridders 1982, Accurate computation of F'(x)
-- and F'(x) F''(x), Advances in Engineering Software 4; Press et al., Numerical recipes, 5.7), of which the entry is chosen whose error
-- is least: that of wide differences is by the curvature, or another kink in between, that of narrow ones by rounding.
local extrapolation = {}

-- How far an entry of the table is from the two that it is made of, and from the one below it, without which one in many would be right
-- by chance; nil: it has not all of them.
local function off_at(rows, k, m)
  local here, below = rows[k][m + 1], rows[k + 1] and rows[k + 1][m + 1]
  if not below or m == 0 then return nil end
  return math.max(math.abs(here - rows[k][m]), math.abs(here - rows[k - 1][m]), math.abs(here - below))
end

-- values at distances that halve, three at least, and the rounding in each. Returns the limit at 0 and its error.
function extrapolation.limit(values, noise)
  local rows, best, least = {}, nil, math.huge
  for k, value in ipairs(values) do
    rows[k] = { value }
    for m = 1, k - 1 do rows[k][m + 1] = rows[k][m] + (rows[k][m] - rows[k - 1][m]) / (2 ^ m - 1) end
  end
  for k = 1, #values do
    for m = 1, k - 1 do
      local off = off_at(rows, k, m)
      if off and off + 3 * noise[k] < least then best, least = rows[k][m + 1], off + 3 * noise[k] end
    end
  end
  return best, least
end

local rounding = 16 * 2 ^ -52 -- of a measure at the end of a run, relative
local stays = 0.8 -- a difference from f that half the distance leaves so large does not go to 0

-- f: its value at p; side: 1 above, -1 below; h: distances, each half of the one before; values: at p + side h. Returns { slope, error,
-- size (the largest value), jump (the narrowest difference from f, which does not go to 0; nil: it does) }.
function extrapolation.side(f, side, h, values)
  local slopes, noise, size, n = {}, {}, math.abs(f), #values
  for _, value in ipairs(values) do size = math.max(size, math.abs(value)) end
  for k, value in ipairs(values) do slopes[k], noise[k] = (value - f) / (side * h[k]), rounding * size / h[k] end
  local slope, off = extrapolation.limit(slopes, noise)
  local last, before = values[n] - f, values[n - 1] - f
  local jumps = last * before > 0 and math.abs(last) > stays * math.abs(before) and math.abs(last) > 100 * rounding * size
  return { slope = slope, error = off, size = size, jump = jumps and last or nil }
end

return extrapolation
