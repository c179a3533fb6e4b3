-- Nonlinear least squares: the parameters p, within bounds, for which the sum of the squares of residuals r(p) is least.
-- Levenberg and Marquardt's method with the scaling of More 1978 (The Levenberg-Marquardt algorithm: implementation and
-- theory): damped Gauss-Newton steps, by an orthogonal decomposition of the Jacobian, so that its condition is not squared.
-- The Jacobian is of central differences. Parameters at a bound that the gradient pushes outwards stay there.
local linear = require("common.fit.linear")
local statistics = require("common.fit.statistics")

local least_squares = {}

local function cost_of(r)
  local sum = 0
  for k = 1, #r do sum = sum + r[k] * r[k] end
  return sum
end

-- The points of central differences, of one side where a bound is nearer than the step.
local function neighbours(p, problem)
  local points = {}
  for j = 1, #p do
    local h = problem.difference * math.max(math.abs(p[j]), problem.scale[j])
    for side = -1, 1, 2 do
      local q = table.move(p, 1, #p, 1, {})
      q[j] = math.min(math.max(p[j] + side * h, problem.low[j]), problem.high[j])
      points[#points + 1] = q
    end
  end
  return points
end

-- J[j][k] = dr_k/dp_j by columns; or nil and why a neighbour cannot be run.
function least_squares.jacobian(p, problem)
  local points = neighbours(p, problem)
  local r, why = problem.evaluate(points, p)
  local J = {}
  for j = 1, #p do
    local below, above = r[2 * j - 1], r[2 * j]
    if not (below and above) then return nil, why[2 * j - 1] or why[2 * j] end
    local width = points[2 * j][j] - points[2 * j - 1][j]
    J[j] = {}
    for k = 1, #above do J[j][k] = (above[k] - below[k]) / width end
  end
  return J
end

-- Which parameters may move: not those at a bound that a descent would leave.
local function free_ones(p, g, problem)
  local free = {}
  for j = 1, #p do
    if not (p[j] <= problem.low[j] and g[j] > 0 or p[j] >= problem.high[j] and g[j] < 0) then free[#free + 1] = j end
  end
  return free
end

-- The step without its parts along directions that change nothing, where it is made of rounding alone.
local function without_blind(step, columns, sizes)
  for _, v in ipairs(linear.blind(statistics.scaled(columns, sizes), statistics.blind)) do
    local along = 0
    for i = 1, #step do along = along + v[i] * step[i] / sizes[i] end
    for i = 1, #step do step[i] = step[i] - along * v[i] * sizes[i] end
  end
end

-- p with the damped step of the free ones, within the bounds; and the length of the step, by the size of the parameters.
local function stepped(state, free, problem)
  local columns, diagonal, sizes, p = {}, {}, {}, state.p
  for i, j in ipairs(free) do
    columns[i], diagonal[i] = state.J[j], math.sqrt(state.damping) * state.D[j]
    sizes[i] = math.max(math.abs(p[j]), problem.scale[j])
  end
  local step = linear.least_squares(columns, state.r, diagonal)
  without_blind(step, columns, sizes)
  local q, length = table.move(p, 1, #p, 1, {}), 0
  for i, j in ipairs(free) do
    q[j] = math.min(math.max(p[j] - step[i], problem.low[j]), problem.high[j])
    length = math.max(length, math.abs(q[j] - p[j]) / sizes[i])
  end
  return q, length
end

-- The largest cosine between the residual and a column of the Jacobian: 0 in a minimum.
local function slope(J, r, free)
  local most, norm = 0, math.sqrt(cost_of(r))
  for _, j in ipairs(free) do
    local column = math.sqrt(cost_of(J[j]))
    if column > 0 and norm > 0 then most = math.max(most, math.abs(linear.dot(J[j], r)) / (column * norm)) end
  end
  return most
end

-- A step that makes the residuals smaller, with ever more damping; nil: there is none.
local function descend(state, free, problem)
  for _ = 1, 30 do
    local q, length = stepped(state, free, problem)
    local found = problem.evaluate({ q }, q)
    local r = found[1]
    if r and cost_of(r) < state.cost then
      state.damping = state.damping / 9
      return q, r, length
    end
    if length < problem.tolerance then return nil end
    state.damping = math.max(state.damping, 1e-6) * 10
  end
end

local function rescale(state)
  for j, column in ipairs(state.J) do
    local norm = math.sqrt(cost_of(column))
    state.D[j] = math.max(state.D[j] or 0, norm)
    if state.D[j] == 0 then state.D[j] = 1 end
  end
end

-- problem: start, low, high, scale (sizes by which steps are judged), difference (step of differences, by the size),
-- tolerance (of the parameters, by the size), most (iterations), evaluate(points, base) -> list of residuals (false: it
-- cannot be run) and list of reasons, note(iteration, cost). Returns { p, r, J, cost, iterations, ended = "converged",
-- "at most N iterations" or "no further descent" }; or nil and the reason.
function least_squares.solve(problem)
  local first, why = problem.evaluate({ problem.start }, problem.start)
  if not first[1] then return nil, why[1] end
  local state = { p = problem.start, r = first[1], cost = cost_of(first[1]), damping = 1e-3, D = {}, iterations = 0 }
  repeat
    local J, reason = least_squares.jacobian(state.p, problem)
    if not J then return nil, reason end
    state.J = J
    if state.ended then break end
    rescale(state)
    local g = {}
    for j = 1, #J do g[j] = linear.dot(J[j], state.r) end
    local free = free_ones(state.p, g, problem)
    if #free == 0 or slope(J, state.r, free) < 1e-10 then state.ended = "converged" break end
    local q, r, length = descend(state, free, problem)
    if not q then state.ended = "converged" break end
    local gained = (state.cost - cost_of(r)) / state.cost
    state.p, state.r, state.cost = q, r, cost_of(r)
    state.iterations = state.iterations + 1
    if problem.note then problem.note(state.iterations, state.cost) end
    if length < problem.tolerance or gained < 1e-13 then state.ended = "converged"
    elseif state.iterations >= problem.most then state.ended = ("at most %d iterations"):format(problem.most) end
  until false
  return state
end

return least_squares
