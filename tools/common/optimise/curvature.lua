-- The second derivatives of a weighted sum of the numbers behind each segment, by central differences of the first ones: where the steps
-- state none themselves, as with constraints. Values of a control at every second knot are changed at once, since a segment has two.
local curvature = {}

local part = 1e-4 -- of the largest number of its kind: what bends further costs part^2, rounding eps/part

local function largest(x, first, last)
  local most = 0
  for e = first, last do most = math.max(most, math.abs(x[e])) end
  return most > 0 and most or 1
end

-- The weighted sum's slope by every column of segment k from X; or nil and why.
local function slope_of(problem, k, X)
  local segment, n, weight = problem.parts[k], #X, problem.weights[k]
  local behind, J = problem.record:segment(segment.first, segment.last, X, true)
  if not behind then return nil, J end
  local q = {}
  for c = 1, #J // n do
    q[c] = 0
    for i = 1, n do q[c] = q[c] + weight[i] * J[(c - 1) * n + i] end
  end
  return q
end

-- Adds the half of a column of differences, and of the row that it is too.
local function add_column(H, c, more, less, by, moves)
  local columns = #more
  for r = 1, columns do
    local half = moves[r] ~= false and (more[r] - less[r]) / (4 * by) or 0
    local a, b = (c - 1) * columns + r, (r - 1) * columns + c
    H[a] = H[a] + half
    H[b] = H[b] + half
  end
end

local function by_states(problem, k, H)
  local X, moves = problem.from[k], problem.moves[k]
  local half, Y = #X // 2, table.move(X, 1, #X, 1, {})
  for e = 1, #X do
    if moves[e] then
      local by = part * (e > half and largest(X, half + 1, #X) or largest(X, 1, half))
      local more, less, why
      Y[e] = X[e] + by
      more, why = slope_of(problem, k, Y)
      if not more then return nil, why end
      Y[e] = X[e] - by
      less, why = slope_of(problem, k, Y)
      if not less then return nil, why end
      Y[e] = X[e]
      add_column(H, e, more, less, by, moves)
    end
  end
  return true
end

-- The slopes of all segments with control j larger by `by` at the knots of one parity; or nil and why.
local function slopes_beside(problem, j, parity, by)
  local knots, u = #problem.parts + 1, table.move(problem.u, 1, #problem.u, 1, {})
  for k = 1, knots do
    if k % 2 == parity then u[(j - 1) * knots + k] = u[(j - 1) * knots + k] + by end
  end
  local fine, why = problem.assign(u)
  local list = {}
  for k = 1, fine and #problem.parts or 0 do
    list[k], why = slope_of(problem, k, problem.from[k])
    if not list[k] then return nil, why end
  end
  return fine and list, why
end

local function by_control(problem, j, H)
  local knots, n = #problem.parts + 1, #problem.from[1]
  local by = part * largest(problem.u, (j - 1) * knots + 1, j * knots)
  for parity = 0, 1 do
    local more, less, why
    more, why = slopes_beside(problem, j, parity, by)
    if not more then return nil, why end
    less, why = slopes_beside(problem, j, parity, -by)
    if not less then return nil, why end
    for k in ipairs(problem.parts) do
      add_column(H[k], n + 2 * j - (k % 2 == parity and 1 or 0), more[k], less[k], by, problem.moves[k])
    end
  end
  return true
end

-- problem: record, parts, from (states at the first knots), weights, moves (which numbers of these move; columns by others are left out),
-- of each segment, u, controls (how many), assign(u) -> true, or nil and why. The list of the segments' H, columns squared, or nil and why.
function curvature.of(problem)
  local H, columns = {}, #problem.from[1] + 2 * problem.controls
  for k in ipairs(problem.parts) do
    H[k] = {}
    for c = 1, columns * columns do H[k][c] = 0 end
    local fine, why = by_states(problem, k, H[k])
    if not fine then return nil, why end
  end
  for j = 1, problem.controls do
    local fine, why = by_control(problem, j, H)
    if not fine then return nil, why end
  end
  local fine, why = problem.assign(problem.u)
  return fine and H, why
end

return curvature
