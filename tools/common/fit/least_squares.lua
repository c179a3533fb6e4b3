-- Nonlinear least squares: the parameters p, within bounds, for which the sum of the squares of residuals r(p) is least.
-- Levenberg and Marquardt's method with the scaling of More 1978 (The Levenberg-Marquardt algorithm: implementation and
-- theory): damped Gauss-Newton steps, by an orthogonal decomposition of the Jacobian, so that its condition is not squared.
-- The Jacobian is of central differences, and on the way from one point to the next of Broyden's update (1965, A class of
-- methods for solving nonlinear simultaneous equations, (4.5)), which costs no runs; where that serves badly, and in the
-- minimum, it is of differences again. Parameters at a bound that the gradient pushes outwards stay there.
local linear = require("common.fit.linear")
local statistics = require("common.fit.statistics")

local least_squares = { stuck = "no further descent" }

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

-- How much the two one-sided differences differ, of their sum: 0 of what is smooth, 1 where all of the change is on one side,
-- infinite where both sides rise alike.
local function bend(below, here, above)
  local apart, sum = 0, 0
  for k = 1, #here do
    apart = apart + (above[k] - 2 * here[k] + below[k]) ^ 2
    sum = sum + (above[k] - below[k]) ^ 2
  end
  if sum > 0 then return math.sqrt(apart / sum) end
  return apart > 0 and math.huge or 0
end

-- J[j][k] = dr_k/dp_j by columns, and the bend of each; or nil and why a neighbour cannot be run. r: the residuals at p.
function least_squares.jacobian(p, problem, here)
  local points = neighbours(p, problem)
  local r, why = problem.evaluate(points, p)
  local J, bends = {}, {}
  for j = 1, #p do
    local below, above = r[2 * j - 1], r[2 * j]
    if not (below and above) then return nil, why[2 * j - 1] or why[2 * j] end
    local width = points[2 * j][j] - points[2 * j - 1][j]
    J[j] = {}
    for k = 1, #above do J[j][k] = (above[k] - below[k]) / width end
    local middle = math.abs(points[2 * j][j] + points[2 * j - 1][j] - 2 * p[j]) < 1e-3 * width -- not beside a bound
    bends[j] = here and middle and bend(below, here, above) or 0
  end
  return J, bends
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

-- A step that makes the residuals smaller, with ever more damping; nil: there is none. What a Jacobian that was updated
-- does not find at once is no reason for damping.
local function descend(state, free, problem)
  for _ = 1, state.exact and 30 or 1 do
    local q, length = stepped(state, free, problem)
    local found = problem.evaluate({ q }, q)
    local r = found[1]
    if r and cost_of(r) < state.cost then
      state.damping = state.damping / 9
      return q, r, length
    end
    if length < problem.tolerance or not state.exact then return nil end
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

-- The change of the residuals from p to q is that of the updated Jacobian: J + (r(q) - r(p) - J s) (D^2 s)^T/(s^T D^2 s), by
-- the scales D of the parameters.
local function update(state, q, r)
  local square, s, miss = 0, {}, {}
  for j = 1, #q do
    s[j] = q[j] - state.p[j]
    square = square + (state.D[j] * s[j]) ^ 2
  end
  for k = 1, #r do
    miss[k] = r[k] - state.r[k]
    for j = 1, #q do miss[k] = miss[k] - state.J[j][k] * s[j] end
  end
  for j = 1, #q do
    local weight, column = state.D[j] ^ 2 * s[j] / square, state.J[j]
    for k = 1, #r do column[k] = column[k] + weight * miss[k] end
  end
  return cost_of(miss)
end

-- Moves to q. Of the Jacobian that led there the update is kept where the residuals are as it foretold, up to what was
-- gained, and where steps become shorter, in time: with residuals that stay large, as by a prior beside data that say something
-- else, updates alone crept on for more than 50 steps. By one parameter it is a secant: it always serves,
-- and of a short step it is a difference itself.
local short = 1e-2
local steep = 1e-3 -- a cosine between the residuals and a column of the Jacobian that no minimum has

local function move(state, q, r, length)
  local gained, miss = state.cost - cost_of(r), update(state, q, r)
  state.p, state.r, state.cost = q, r, cost_of(r)
  state.iterations = state.iterations + 1
  state.slow = length > state.length / 2 and state.slow + 1 or 0
  state.length = length
  state.serves = #q == 1 or miss <= gained and state.slow < 2 * #q -- as many runs as new differences take
  state.exact = #q == 1 and length < short
  for j = 1, #q do state.bends[j] = 0 end -- not known here
end

local function renew(state, problem)
  local J, bends = least_squares.jacobian(state.p, problem, state.r)
  if not J then return nil, bends end
  state.J, state.bends, state.exact, state.slow = J, bends, true, 0
  rescale(state)
  return true
end

local function free_of(state, problem)
  local g = {}
  for j = 1, #state.J do g[j] = linear.dot(state.J[j], state.r) end
  return free_ones(state.p, g, problem)
end

-- Whether a step by the Jacobian as it is would be too short to matter; one that was updated cannot tell.
local function is_least(state, free, problem)
  if #free == 0 or slope(state.J, state.r, free) < 1e-10 then return true end
  local _, length = stepped(state, free, problem)
  return length < problem.tolerance
end

-- Whether no step makes the squares smaller where by the derivatives one should: in a kink, or by noise of the runs.
local function is_stuck(state, free, problem)
  if #free == 0 or slope(state.J, state.r, free) < steep then return false end
  local damping = state.damping
  state.damping = 0
  local _, length = stepped(state, free, problem)
  state.damping = damping
  return length > 1e3 * problem.tolerance
end

-- One iteration; whether it was the last, by what the Jacobian says, or nil and why it cannot be run.
local function iterate(state, problem)
  local free = free_of(state, problem)
  if #free == 0 or slope(state.J, state.r, free) < 1e-10 then return true end
  local q, r, length = descend(state, free, problem)
  if not q then return true end
  local gained = (state.cost - cost_of(r)) / state.cost
  move(state, q, r, length)
  if problem.note then problem.note(state.iterations, state.cost, q) end
  return length < problem.tolerance or gained < 1e-13
end

-- problem: start, low, high, scale (sizes by which steps are judged), difference (step of differences, by the size),
-- tolerance (of the parameters, by the size), most (iterations), evaluate(points, base) -> list of residuals (false: it
-- cannot be run) and list of reasons, note(iteration, cost, p). Returns { p, r, J, bends, cost, iterations, ended = "converged",
-- "at most N iterations" or "no further descent" }; or nil and the reason.
function least_squares.solve(problem)
  local first, why = problem.evaluate({ problem.start }, problem.start)
  if not first[1] then return nil, why[1] end
  local state = { p = problem.start, r = first[1], cost = cost_of(first[1]), damping = 1e-3, D = {}, iterations = 0,
    slow = 0, length = math.huge }
  local fine, reason = renew(state, problem)
  if not fine then return nil, reason end
  repeat
    local exact = state.exact
    local last = iterate(state, problem)
    if not state.exact and (last or not state.serves or state.iterations >= problem.most) then
      fine, reason = renew(state, problem)
      if not fine then return nil, reason end
    end
    if last and (exact or is_least(state, free_of(state, problem), problem)) then
      state.ended = is_stuck(state, free_of(state, problem), problem) and least_squares.stuck or "converged"
    elseif state.iterations >= problem.most then state.ended = ("at most %d iterations"):format(problem.most) end
  until state.ended
  return state
end

return least_squares
