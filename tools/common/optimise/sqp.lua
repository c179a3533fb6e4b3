-- The least cost(y) with c(y) = 0 and bounds of linear functions of y: sequential quadratic programming with a damped BFGS
-- matrix for the Lagrangian (Powell 1978; Nocedal and Wright, Numerical Optimization, 18.3 and procedure 18.2), a line search on
-- cost + r sum |c| (18.5), in which goals with a range count by what is beyond it, and a correction of second order where the whole
-- step fails (18.11). Where the cost is |y|^2 and c linear the first step is the optimum.
local linear = require("common.fit.linear")
local quadratic = require("common.optimise.quadratic")
local ranges = require("common.optimise.ranges")

local sqp = {}
local add, times = quadratic.add, quadratic.times

local most_halvings, most_corrections = 14, 4
local bottomless = 1e12 -- a cost that has fallen by so much of what there was has no least value

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

local function length(x) return math.sqrt(linear.dot(x, x)) end

-- What is missing of the goals in `rows`, a list of numbers of those with a value, and of the ranges.
local function missing_of(c, rows, limits)
  local sum = 0
  for _, i in ipairs(rows) do sum = sum + math.abs(c[i]) end
  for _, x in ipairs(limits:beyond(c)) do sum = sum + math.abs(x) end
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

-- The step of the quadratic program; where the bounds leave none, of one that asks for a part of what is missing.
local function direction(state, problem)
  local bounds, limits, part = problem.bounds, problem.limits, 1
  local at, equal = bounds and bounds.values(state.y) or {}, problem.limits.equal
  local function change(r, p) return linear.dot(state.A[equal + r], p) end
  local function row(r) return state.A[equal + r] end
  for _ = 1, (bounds or #limits.low > 0) and 6 or 1 do
    local c, all = {}, limits:bounds(bounds, at, state.c, part, change, row)
    for i = 1, equal do c[i] = part * state.c[i] end
    local step, contradiction = quadratic.solve(state.B, state.slope, table.move(state.A, 1, equal, 1, {}), c, state.negligible, all)
    state.contradiction, part = contradiction, part / 4
    if step then
      step.multipliers = limits:multipliers(step, #at)
      return step
    end
  end
end

-- The step that lowers the merit enough; nil: none does. Where the goals bend, what a step misses of them is taken back by
-- steps of their own, with the present derivatives, before it is given up for a shorter one.
local function search(state, step, penalty, problem)
  local limits, controls = problem.limits, problem.bounds and #state.y or 0
  local now, missing = state.cost, missing_of(state.c, step.kept, limits)
  local fall = linear.dot(state.slope, step.p) - penalty * missing
  local part = 1
  for _ = 1, most_halvings do
    local y = add(state.y, part, step.p)
    local enough, last = now + penalty * missing + 1e-4 * part * fall + 1e-14 * math.abs(now), math.huge
    for _ = 0, most_corrections do
      local there = problem.evaluate(y, false)
      local misses = there and missing_of(there.c, step.kept, limits) or math.huge
      if there and there.cost + penalty * misses <= enough then return y end
      local back = misses < last and quadratic.back(step, there.c, nil, limits:taken_back(there.c, controls))
      if not back then break end
      y, last = add(y, -1, back), misses
      if problem.bounds then y = problem.bounds.clip(y) end
    end
    part = part / 2
  end
end

-- How far from an optimum: the goals, relative to y, and the Lagrangian's slope, relative to the cost's. Without goals these two are
-- the same, which has to be small beside that at the start, or to change the cost by little along all of y.
local function is_optimal(state, step, tolerance, limits)
  local size = length(state.y)
  local slope = tolerance * (length(state.slope) + 2e-3 * state.first)
  if #state.c == 0 then slope = tolerance * math.max(state.steep, size > 0 and math.abs(state.cost) / size or 0) end
  return missing_of(state.c, step.kept, limits) <= tolerance * math.max(size, state.first) and length(step.slope) <= slope
end

-- Scales every goal by how much of y it takes to change it by 1; of those that nothing changes by the largest of the others.
local function scales(A)
  local sizes, most, list = {}, 0, {}
  for i = 1, #A do
    sizes[i] = length(A[i])
    most = math.max(most, sizes[i])
  end
  for i = 1, #A do list[i] = 1 / (sizes[i] > 1e-12 * most and sizes[i] or most > 0 and most or 1) end
  return list
end

-- The weight of what is missing in the merit: above every multiplier, and falling with them slowly (Powell 1978).
local function weight_of(multipliers, before)
  local most = 0
  for i = 1, #multipliers do most = math.max(most, 1.5 * math.abs(multipliers[i])) end
  return math.max(most, (before + most) / 2)
end

-- The matrix of the cost alone, plain: nothing has been learned of curvatures. That of |y|^2 is 2.
local function begin_matrix(state, n) state.H, state.B, state.plain = identity(n, 2), identity(n, 0.5), true end

-- Goes to y, where cost, slope, c and A are those of `there`.
local function learn(state, y, there, multipliers)
  local n = #y
  local q = add(add(there.slope, 1, transposed_times(there.A, multipliers, n)), -1,
    add(state.slope, 1, transposed_times(state.A, multipliers, n)))
  update(state, add(y, -1, state.y), q)
  state.y, state.plain = y, false
  state.cost, state.slope, state.c, state.A = there.cost, there.slope, there.c, there.A
end

-- The evaluation with every goal scaled; that at the start has been taken.
local function scaled(evaluate, scale, first)
  return function(y, gradient)
    local found, reason = first, nil
    first = nil
    if not found then found, reason = evaluate(y, gradient) end
    if not found then return nil, reason end
    for i = 1, #scale do
      found.c[i] = found.c[i] * scale[i]
      for k = 1, gradient and #y or 0 do found.A[i][k] = found.A[i][k] * scale[i] end
    end
    return found
  end
end

local function result(state, scale, iterations, ended)
  if state.contradiction then return nil, nil, state.contradiction end
  local reach, size = {}, length(state.y)
  for i = 1, #scale do reach[i] = size / scale[i] end
  return { y = state.y, cost = state.cost, iterations = iterations, ended = ended, reach = reach }
end

local function begin(options)
  local first, why = options.evaluate(options.start, true)
  if not first then return nil, why end
  local scale = scales(first.A)
  local goals = options.goals or {}
  for i = #goals + 1, #first.c do goals[i] = { value = 0 } end
  local problem = { bounds = options.bounds, limits = ranges.of(goals, scale), evaluate = scaled(options.evaluate, scale, first) }
  local state = problem.evaluate(options.start, true)
  state.y, state.first, state.negligible = options.start, problem.limits:missing(state.c), {}
  for i = 1, #state.c do
    state.negligible[i] = options.negligible and options.negligible[i] * scale[i] or 0
  end
  state.steep = length(state.slope)
  begin_matrix(state, #state.y)
  return state, problem, scale
end

-- options: start (y), evaluate(y, gradient) -> { cost =, slope =, c =, A = } or nil and why, most (iterations), tolerance,
-- negligible (of each number of c), goals (of common/optimise/ranges.lua: of those with a range c is the measure itself; nil: all c
-- are to be 0), note(iteration, cost, missing, y), bounds: { low =, high =, values(y) -> the numbers that have them, row(k) -> the
-- k-th by y, clip(y) -> y within them }, or nil.
-- Returns { y, cost, iterations, ended, reach }, reach: by how much y moves each number of c, about; or nil and why; or nil,
-- nil and the contradiction { row =, others = }: a number of c that y cannot change apart from the others; others nil: that the
-- bounds keep from 0.
function sqp.minimise(options)
  local state, problem, scale = begin(options)
  if not state then return nil, problem end
  local penalty, lowest, rows = 0, -bottomless * (1 + math.abs(state.cost)), {}
  local limits = problem.limits
  for i = 1, limits.equal do rows[i] = i end
  for iteration = 1, options.most do
    local step = direction(state, problem)
    if options.note then options.note(iteration, state.cost, missing_of(state.c, rows, limits), state.y) end
    if not step then
      return nil, nil, { row = limits:worst(state.c) }
    end
    if is_optimal(state, step, options.tolerance, limits) then
      return result(state, scale, iteration - 1, "converged")
    end
    if state.cost < lowest then return nil, "the cost has no lower bound: it falls as far as controls are let" end
    penalty = weight_of(step.multipliers, penalty)
    local y = search(state, step, penalty, problem)
    if not y and state.plain then return result(state, scale, iteration, "a search without a way down") end
    if y then
      local there, reason = problem.evaluate(y, true)
      if not there then return nil, reason end
      learn(state, y, there, step.multipliers)
    else begin_matrix(state, #state.y) end
  end
  return result(state, scale, options.most, "as many iterations as --most")
end

return sqp
