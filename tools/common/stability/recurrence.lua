-- The growth of a sequence that obeys a linear recurrence s(k+p) = sum c_j s(k+j): the largest of its characteristic
-- roots (Prony 1795). The smallest p whose least-squares residual is at rounding level is taken. Components too small to
-- affect the residual have decayed, so they are not the largest.
local recurrence = {}

local startup, most_order = 8, 7
-- The residual of the right recurrence is 1e-15 to 1e-10, depending on the method's algebraic tolerance; a longer one
-- is taken where it fits a hundred times better. A motion that decays below 1e-5 of its size at the start soon reaches
-- rounding level, where any recurrence fits: the growth is then taken from the decay itself.
local rounding, residual_limit, better, decay_limit = 1e-13, 1e-8, 0.01, 1e-5

local function size_of(sequences, first, last)
  local size = 0
  for _, s in ipairs(sequences) do
    for k = first, last do
      if s[k] ~= s[k] then return math.huge end
      size = math.max(size, math.abs(s[k]))
    end
  end
  return size
end

-- Rows s(k) .. s(k+p-1) | s(k+p) of all sequences, each scaled to 1, without those at rounding level.
local function equations(sequences, p)
  local rows = {}
  for k = startup, #sequences[1] - p do
    local common = size_of(sequences, k, k + p)
    for _, s in ipairs(sequences) do
      local row, size = {}, size_of({ s }, k, k + p)
      for j = 0, p do row[j + 1] = s[k + j] / size end
      if size > decay_limit * common then rows[#rows + 1] = row end
    end
  end
  return rows
end

-- Least squares by Householder reflections: the coefficients, and the RMS residual.
local function least_squares(rows, p)
  local m = #rows
  for j = 1, p do
    local norm, dot = 0, {}
    for i = j, m do norm = norm + rows[i][j] ^ 2 end
    norm = math.sqrt(norm)
    if norm < 1e-14 then return nil end
    if rows[j][j] > 0 then norm = -norm end
    local head = rows[j][j] - norm
    for c = j + 1, p + 1 do
      local sum = head * rows[j][c]
      for i = j + 1, m do sum = sum + rows[i][j] * rows[i][c] end
      dot[c] = sum / (norm * head)
    end
    for c = j + 1, p + 1 do
      rows[j][c] = rows[j][c] + dot[c] * head
      for i = j + 1, m do rows[i][c] = rows[i][c] + dot[c] * rows[i][j] end
    end
    rows[j][j] = norm
  end
  local c, rest = {}, 0
  for j = p, 1, -1 do
    local sum = rows[j][p + 1]
    for l = j + 1, p do sum = sum - rows[j][l] * c[l] end
    c[j] = sum / rows[j][j]
  end
  for i = p + 1, m do rest = rest + rows[i][p + 1] ^ 2 end
  return c, math.sqrt(rest / math.max(1, m - p))
end

-- |M^N|^(1/N), N = 2^45: the largest root of u^p = sum c_j u^(j-1), through the companion matrix.
local function largest_root(c, p)
  local M, logarithm, weight = {}, 0, 1
  for i = 1, p do
    M[i] = {}
    for j = 1, p do M[i][j] = i == p and c[j] or j == i + 1 and 1 or 0 end
  end
  for _ = 1, 45 do
    local size, square = 0, {}
    for i = 1, p do for j = 1, p do size = math.max(size, math.abs(M[i][j])) end end
    if size == 0 then return 0 end
    logarithm = logarithm + weight * math.log(size)
    weight = weight / 2
    for i = 1, p do
      square[i] = {}
      for j = 1, p do
        local sum = 0
        for l = 1, p do sum = sum + M[i][l] * M[l][j] / size / size end
        square[i][j] = sum
      end
    end
    M = square
  end
  return math.exp(logarithm)
end

-- The last step before the motion decays below `decay_limit` times its largest size.
local function last_before_decay(sequences)
  local most = 0
  for k = 1, #sequences[1] do
    local size = size_of(sequences, k, k)
    most = math.max(most, size)
    if size <= decay_limit * most then return k - 1 end
  end
  return #sequences[1]
end

-- The growth factor of a step; nil: no recurrence fits, since the method's steps are not linear.
function recurrence.growth_of(sequences)
  local count = #sequences[1]
  if size_of(sequences, 1, count) == math.huge then return math.huge end
  local last = last_before_decay(sequences)
  if last < 3 then return 0 end
  if last < count then return (size_of(sequences, last, last) / size_of(sequences, 1, 1)) ^ (1 / (last - 1)) end
  local best, least = nil, residual_limit / better
  for p = 1, most_order do
    local c, residual = least_squares(equations(sequences, p), p)
    if c and residual <= better * least then best, least = largest_root(c, p), residual end
    if least <= rounding then break end
  end
  return best
end

return recurrence
