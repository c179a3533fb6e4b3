-- The least |y|^2 with c(y) = 0: sequential quadratic programming with a damped BFGS matrix for the Lagrangian (Powell 1978;
-- Nocedal and Wright, Numerical Optimization, 18.3 and procedure 18.2), a line search on |y|^2 + r sum |c| (18.5) and a
-- correction of second order where the whole step fails (18.11). Where c is linear the first step is the optimum.
local linear = require("common.fit.linear")

local sqp = {}

local most_halvings, most_corrections = 14, 4

local function add(x, part, p)
  local sum = {}
  for k = 1, #x do sum[k] = x[k] + part * p[k] end
  return sum
end

local function times(M, x)
  local product = {}
  for k = 1, #M do product[k] = linear.dot(M[k], x) end
  return product
end

local function transposed_times(A, x, n)
  local product = {}
  for k = 1, n do product[k] = 0 end
  for i = 1, #A do
    for k = 1, n do product[k] = product[k] + A[i][k] * x[i] end
  end
  return product
end

local function identity(n, value)
  local M = {}
  for i = 1, n do
    M[i] = {}
    for k = 1, n do M[i][k] = i == k and value or 0 end
  end
  return M
end

-- x with S x = b for a small symmetric positive S, by Cholesky's factors; nil and the row that follows from those before.
local function solve_small(S, b)
  local n, L, x = #S, {}, {}
  for i = 1, n do
    L[i] = {}
    for k = 1, i do
      local sum = S[i][k]
      for j = 1, k - 1 do sum = sum - L[i][j] * L[k][j] end
      if i == k and (sum <= 1e-14 * S[i][i] or sum ~= sum) then return nil, i end
      L[i][k] = i == k and math.sqrt(sum) or sum / L[k][k]
    end
  end
  for i = 1, n do
    x[i] = b[i]
    for k = 1, i - 1 do x[i] = x[i] - L[i][k] * x[k] end
    x[i] = x[i] / L[i][i]
  end
  for i = n, 1, -1 do
    for k = i + 1, n do x[i] = x[i] - L[k][i] * x[k] end
    x[i] = x[i] / L[i][i]
  end
  return x
end

local function sum_of_sizes(c)
  local sum = 0
  for i = 1, #c do sum = sum + math.abs(c[i]) end
  return sum
end

-- H and its inverse B after the step s in which the Lagrangian's gradient changed by q.
local function update(state, s, q)
  local Hs = times(state.H, s)
  local sHs, sq = linear.dot(s, Hs), linear.dot(s, q)
  if sq < 0.2 * sHs then
    local part = 0.8 * sHs / (sHs - sq)
    for k = 1, #q do q[k] = part * q[k] + (1 - part) * Hs[k] end
    sq = linear.dot(s, q)
  end
  if not (sHs > 0 and sq > 0) then return end
  local Bq = times(state.B, q)
  local qBq, n = linear.dot(q, Bq), #s
  for i = 1, n do
    local H, B = state.H[i], state.B[i]
    for k = 1, n do
      H[k] = H[k] - Hs[i] * Hs[k] / sHs + q[i] * q[k] / sq
      B[k] = B[k] + (1 + qBq / sq) * s[i] * s[k] / sq - (Bq[i] * s[k] + s[i] * Bq[k]) / sq
    end
  end
end

-- The direction and the multipliers; or nil and why there is none.
local function direction(state)
  local y, A, c, n = state.y, state.A, state.c, #state.y
  local gradient, S, right, BA = add(y, 1, y), {}, {}, {}
  local Bg = times(state.B, gradient)
  for i = 1, #A do BA[i] = times(state.B, A[i]) end
  for i = 1, #A do
    S[i], right[i] = {}, c[i] - linear.dot(A[i], Bg)
    for k = 1, #A do S[i][k] = linear.dot(A[i], BA[k]) end
  end
  local multipliers, row = solve_small(S, right)
  if not multipliers then return nil, row end
  local p = add(Bg, 1, transposed_times(BA, multipliers, n))
  for k = 1, n do p[k] = -p[k] end
  state.S, state.BA = S, BA
  state.slope = add(gradient, 1, transposed_times(A, multipliers, n)) -- of the Lagrangian
  return p, multipliers
end

local function merit(y, c, penalty) return linear.dot(y, y) + penalty * sum_of_sizes(c) end

-- The step that lowers the merit enough; nil: none does. Where the goals bend, what a step misses of them is taken back by
-- steps of their own, with the present derivatives, before it is given up for a shorter one.
local function search(state, p, penalty, evaluate)
  local now, missing = merit(state.y, state.c, penalty), sum_of_sizes(state.c)
  local fall = 2 * linear.dot(state.y, p) - penalty * missing
  local part = 1
  for _ = 1, most_halvings do
    local y = add(state.y, part, p)
    local enough, last = now + 1e-4 * part * fall + 1e-14 * math.abs(now), math.huge
    for _ = 0, most_corrections do
      local there = evaluate(y, false)
      local misses = there and sum_of_sizes(there.c) or math.huge
      if there and merit(y, there.c, penalty) <= enough then return y end
      local back = misses < last and solve_small(state.S, there.c)
      if not back then break end
      y, last = add(y, -1, transposed_times(state.BA, back, #y)), misses
    end
    part = part / 2
  end
end

-- How far from an optimum: the goals, and the Lagrangian's slope, each relative to y.
local function is_optimal(state, tolerance)
  local size, slope = math.sqrt(linear.dot(state.y, state.y)), math.sqrt(linear.dot(state.slope, state.slope))
  return sum_of_sizes(state.c) <= tolerance * math.max(size, state.first)
    and slope <= 2 * tolerance * math.max(size, 1e-3 * state.first)
end

-- Scales every goal by how much of y it takes to change it by 1; nil and the goal that nothing changes.
local function scales(A)
  local list = {}
  for i = 1, #A do
    local size = math.sqrt(linear.dot(A[i], A[i]))
    if size == 0 or size ~= size then return nil, i end
    list[i] = 1 / size
  end
  return list
end

-- The weight of what is missing in the merit: above every multiplier, and falling with them slowly (Powell 1978).
local function weight_of(multipliers, before)
  local most = 0
  for i = 1, #multipliers do most = math.max(most, 1.5 * math.abs(multipliers[i])) end
  return math.max(most, (before + most) / 2)
end

-- The matrix of |y|^2 alone, plain: nothing has been learned of the goals' curvature.
local function begin_matrix(state, n) state.H, state.B, state.plain = identity(n, 2), identity(n, 0.5), true end

-- Goes to y, where c and A are those of `there`.
local function learn(state, y, there, multipliers)
  local s = add(y, -1, state.y)
  local q = add(add(s, 1, s), 1, transposed_times(there.A, multipliers, #y))
  update(state, s, add(q, -1, transposed_times(state.A, multipliers, #y)))
  state.y, state.c, state.A, state.plain = y, there.c, there.A, false
end

-- The evaluation with every goal scaled.
local function scaled(evaluate, scale)
  return function(y, gradient)
    local found, reason = evaluate(y, gradient)
    if not found then return nil, reason end
    for i = 1, #scale do
      found.c[i] = found.c[i] * scale[i]
      for k = 1, gradient and #y or 0 do found.A[i][k] = found.A[i][k] * scale[i] end
    end
    return found
  end
end

local function result(state, scale, iterations, ended)
  local reach, size = {}, math.sqrt(linear.dot(state.y, state.y))
  for i = 1, #scale do reach[i] = size / scale[i] end
  return { y = state.y, cost = size * size, iterations = iterations, ended = ended, reach = reach }
end

-- options: start (y), evaluate(y, gradient) -> { c =, A = } or nil and why, most (iterations), tolerance, note(iteration,
-- cost, missing). Returns { y, cost, iterations, ended, reach }, reach: by how much y moves each number of c, about; or nil
-- and why; or nil, nil and the number of c that y cannot change apart from those before it.
function sqp.minimise(options)
  local first, why = options.evaluate(options.start, true)
  if not first then return nil, why end
  local scale, row = scales(first.A)
  if not scale then return nil, nil, row end
  local evaluate, n, penalty = scaled(options.evaluate, scale), #options.start, 0
  local state = evaluate(options.start, true)
  state.y, state.first = options.start, sum_of_sizes(state.c)
  begin_matrix(state, n)
  for iteration = 1, options.most do
    local p, multipliers = direction(state)
    if not p then return nil, nil, multipliers end
    if options.note then options.note(iteration, linear.dot(state.y, state.y), sum_of_sizes(state.c)) end
    if is_optimal(state, options.tolerance) then return result(state, scale, iteration - 1, "converged") end
    penalty = weight_of(multipliers, penalty)
    local y = search(state, p, penalty, evaluate)
    if not y and state.plain then return result(state, scale, iteration, "a search without a way down") end
    if y then
      local there, reason = evaluate(y, true)
      if not there then return nil, reason end
      learn(state, y, there, multipliers)
    else begin_matrix(state, n) end
  end
  return result(state, scale, options.most, "as many iterations as --most")
end

return sqp
