-- The least effort by transcription: unknown are the controls and the states at all knots, and that the steps between two knots lead
-- from one to the next is an equation for each number (Bock and Plitt 1984: direct multiple shooting; on the integrator's own steps,
-- as Ober-Bloebaum, Junge and Marsden 2011 have them). Newton's method on the Lagrangian, with second derivatives of the
-- equations; its quadratic program, banded in time, is solved in as many operations as there are knots (tools/native/horizon.c);
-- goals and bounds by the dual method over that; a line search on the effort and what is missing of every equation.
local horizon = require("horizon")
local linear = require("common.fit.linear")
local quadratic = require("common.optimise.quadratic")
local ranges = require("common.optimise.ranges")
local tangents = require("common.optimise.tangents")

local transcription = {}

local most_halvings, most_corrections = 12, 8

local function zeros(n)
  local x = {}
  for k = 1, n do x[k] = 0 end
  return x
end

-- ---- the effort: the integral of the squares of controls, linear between knots ----

-- Half of its slope by all values: W u.
local function effort_slope(state, u)
  local list, part = {}, state.interval / 6
  for first = 0, state.n - 1, state.knots do
    for k = first + 1, first + state.knots do
      local before, behind = k > first + 1, k < first + state.knots
      list[k] = part * ((before and u[k - 1] + 2 * u[k] or 0) + (behind and u[k + 1] + 2 * u[k] or 0))
    end
  end
  return list
end

-- What is to be least: at an evaluation, the scene's own cost.
local function cost_at(state, u, there) return state.own and there.cost or linear.dot(u, effort_slope(state, u)) end

-- Its slope by the controls; that of the scene's own cost by the states is there.by_states.
local function cost_slope(state)
  if state.own then return state.there.by_controls end
  local slope = effort_slope(state, state.u)
  return quadratic.add(slope, 1, slope)
end

-- ---- one iteration ----

-- Rows of the quadratic program stand in the controls and, behind these, in the goals: what a step changes of each. So a goal's row
-- has one number, and its image comes from the recursion that has factored the matrix, not from a product along all segments.
local function goal_row(state, i)
  local row = zeros(state.n + #state.goals)
  row[state.n + i] = 1
  return row
end

-- Those of goals with a value.
local function goal_rows(state)
  local rows = {}
  for i = 1, state.limits.equal do rows[i] = goal_row(state, i) end
  return rows
end

local function split(state, row)
  return table.move(row, 1, state.n, 1, {}), table.move(row, state.n + 1, state.n + #state.goals, 1, {})
end

local function joined(u, y) return table.move(y, 1, #y, #u + 1, table.move(u, 1, #u, 1, {})) end

-- The inverse of the matrix along the equations, applied to a row.
local function image_of(state, row)
  local slope, prices = split(state, row)
  local u, y = state.horizon:least(slope, prices)
  local image = joined(u, y)
  for k = 1, #image do image[k] = -image[k] end
  return image
end

-- How each goal changes with the controls.
local function reaches(state)
  local A = {}
  for i = 1, #state.goals do A[i] = state.horizon:row(i) end
  return A
end

-- The goals with a value at the same knot, mixed so that the controls move each by as much and none with another: by Gram's and
-- Schmidt's sums, a line of parts for each goal, nil for one that follows from those before it. So the squares below weigh what stiff
-- links hide: posts of one body that move together, which differ by little.
local function mix(state, A)
  local rows, lines = {}, {}
  for i = 1, state.limits.equal do
    local row, line, whole = A[i], zeros(i), linear.dot(A[i], A[i])
    line[i] = 1
    for k = 1, i - 1 do
      if lines[k] and state.goals[k].knot == state.goals[i].knot then
        local part = linear.dot(row, rows[k])
        row = quadratic.add(row, -part, rows[k])
        for e = 1, k do line[e] = line[e] - part * lines[k][e] end
      end
    end
    local rest = linear.dot(row, row)
    if rest > 1e-12 * whole then
      local part = 1 / math.sqrt(rest)
      rows[i], lines[i] = quadratic.add(row, part - 1, row), quadratic.add(line, part - 1, line)
    end
  end
  return lines
end

-- What is missing of the mixed goals.
local function mixed(state, missing)
  local list = zeros(#missing)
  for i, line in pairs(state.mix) do
    for k, part in ipairs(line) do list[i] = list[i] + part * missing[k] end
  end
  return list
end

-- Factors the matrix. Where it is not positive along the equations the squares of the mixed goals are added, which change nothing
-- where the goals are met, and make it positive where it is along them; where that does not help, the equations' curvature is left out,
-- as Gauss and Newton do: the effort alone is convex. (A multiple of 1 in its place, Waechter's and Biegler's correction of inertia, holds
-- states back that must go far: Luxo's lamp does not jump with it, and cart and pole took 28 iterations for 23.) False: never.
local function factor(state, A)
  state.mix = {}
  if state.horizon:factor(0) then return true end
  state.mix = mix(state, A)
  for i, line in pairs(state.mix) do
    local slope = zeros(state.d)
    for k, part in ipairs(line) do slope = quadratic.add(slope, part, state.there.slopes[k]) end
    state.horizon:square(i, slope)
  end
  local weight = 100 * 4 / 3 * state.interval
  for _ = 1, next(state.mix) and 3 or 0 do
    if state.horizon:factor(weight) then return true end
    weight = 30 * weight
  end
  for k = 1, state.knots - 1 do state.horizon:segment(k, state.there.J[k], state.own and state.there.G[k] or nil) end
  for k = 1, state.knots do state.horizon:bend(k, nil) end
  return state.horizon:factor(0)
end

-- Bounds of controls and, where measures have the values c, of goals with a range.
local function with_bounds(state, c, part)
  local own, goals, equal = state.bounds, #state.goals, state.limits.equal
  local bounds = own and setmetatable({ row = function(k) return joined(own.row(k), zeros(goals)) end }, { __index = own })
  return state.limits:bounds(bounds, state.u, c, part, function(r, p) return p[state.n + equal + r] end,
    function(r) return goal_row(state, equal + r) end)
end

local function bounded_controls(state) return state.bounds and state.n or 0 end

-- The quadratic program that asks for a part of what is missing of the goals, less where there is no step; y: what the equations alone
-- change of them.
local function program(state, slope, y, least)
  local part, none = 1, zeros(#y)
  for _ = 1, (state.bounds or #state.limits.low > 0) and 6 or 1 do
    local c, equal = {}, state.limits.equal
    for i = 1, equal do c[i] = part * state.missing[i] + y[i] end
    for i = equal + 1, #y do c[i] = state.there.goals[i] + y[i] end
    local step, contradiction = quadratic.solve(function(row) return image_of(state, row) end, joined(slope, none), goal_rows(state),
      c, state.negligible, with_bounds(state, c, part), joined(least, zeros(#y)))
    state.contradiction = contradiction
    if step then
      step.asked, step.multipliers = part, state.limits:multipliers(step, bounded_controls(state))
      return step
    end
    part = part / 4
  end
end

-- The step of the quadratic program: p of the controls, x of the states, and multipliers of goals and equations.
local function direction(state)
  local A = reaches(state)
  state.A = nil
  if not factor(state, A) then return nil end
  state.A = A
  local slope = cost_slope(state)
  local u, y = state.horizon:least(slope, nil, state.defect, mixed(state, state.missing), state.there.by_states)
  local step = program(state, slope, y, u)
  if not step then return nil end
  local prices
  slope, prices = split(state, step.slope)
  step.p, step.y, step.x, step.equations = state.horizon:least(slope, prices, state.defect, mixed(state, state.missing),
    state.there.by_states)
  if state.there.along then step.equations = tangents.multipliers(state.there.along, step.equations) end
  return step
end

-- What is missing of every equation, at what evaluation there is.
local function gaps(state, nodes, there)
  local defect, missing = {}, {}
  for k = 1, state.knots - 1 do
    local gap, behind, node = {}, there.ends[k], nodes[k + 1]
    for i = 1, state.d do gap[i] = behind[i] - node[i] end
    defect[k] = there.along and tangents.along(there.along[k + 1], gap) or gap
  end
  for i, goal in ipairs(state.goals) do missing[i] = ranges.missed(goal, there.goals[i]) end
  return defect, missing
end

-- All that is missing, by the weights of the merit.
local function sum_of(state, defect, missing)
  local sum, d, penalty = 0, state.d, state.penalty
  for k = 1, #defect do
    local gap = defect[k]
    for i = 1, d do sum = sum + penalty[i] * math.abs(gap[i]) end
  end
  for i = 1, #missing do sum = sum + state.price[i] * math.abs(missing[i]) end
  return sum
end

-- Weights above all multipliers, which fall slowly (Powell 1978): one for a number of the state at all knots. (One for each knot as
-- well takes Luxo's lamp to its optimum in fewer iterations, but its ski jump, from muscles that do nothing, nowhere.)
local function weigh(state, step, list)
  for i = 1, state.d do
    local most = 0
    for k = 1, #list do most = math.max(most, 1.5 * math.abs(list[k][i])) end
    state.penalty[i] = math.max(most, (state.penalty[i] + most) / 2)
  end
  for i = 1, #state.goals do
    local most = 1.5 * math.abs(step.multipliers[i])
    state.price[i] = math.max(most, (state.price[i] + most) / 2)
  end
end

-- Behind a step states lie off the constraints that hold them, by its square: they are put back (tangents.lua).
local function changed(state, nodes, part, x)
  local list = { nodes[1] }
  for k = 2, state.knots do
    local node = quadratic.add(nodes[k], part, x[k])
    list[k] = state.place and state.place(node) or node
  end
  return list
end

local function moved(state, step, part)
  local nodes = changed(state, state.nodes, part, step.x)
  return nodes, quadratic.add(state.u, part, step.p)
end

local function within(state, u)
  for k, low in ipairs(state.bounds and state.bounds.low or {}) do u[k] = math.min(math.max(u[k], low), state.bounds.high[k]) end
  return u
end

-- The nodes and controls from which what is missing there is taken back, by the derivatives that the step has: the correction of
-- second order, without which the merit forbids whole steps along bent equations (Maratos; Nocedal and Wright 18.3).
local function corrected(state, step, nodes, u, defect, missing)
  local off_squares = mixed(state, missing)
  local base, y = state.horizon:least(nil, nil, defect, off_squares)
  local off = table.move(missing, state.limits.equal + 1, #missing, bounded_controls(state) + 1, {})
  local _, weight = quadratic.back(step, missing, joined(base, y), off)
  local row = zeros(state.n + #missing)
  for i, part in ipairs(weight) do row = quadratic.add(row, part, step.set.rows[i]) end
  local slope, prices = split(state, row)
  local back, _, change = state.horizon:least(slope, prices, defect, off_squares)
  return changed(state, nodes, 1, change), within(state, quadratic.add(u, 1, back))
end

-- Goes along the step as far as the merit falls; false: nowhere.
local function search(state, step, evaluate)
  local now = sum_of(state, state.defect, state.missing)
  local slope = linear.dot(cost_slope(state), step.p) - step.asked * now
  for k, by in ipairs(state.there.by_states or {}) do slope = slope + linear.dot(by, step.x[k]) end
  local merit, part = cost_at(state, state.u, state.there) + now, 1
  for _ = 1, most_halvings do
    local nodes, u = moved(state, step, part)
    local last = math.huge
    for _ = 0, step.asked == 1 and most_corrections or 0 do
      local there, sum, defect, missing = evaluate(u, nodes, false), math.huge, nil, nil
      if there then
        defect, missing = gaps(state, nodes, there)
        sum = sum_of(state, defect, missing)
      end
      local cost = there and cost_at(state, u, there)
      if there and cost + sum <= merit + 1e-4 * part * slope + 1e-13 * math.abs(merit) then
        state.nodes, state.u, state.cost = nodes, u, cost
        return part
      end
      if sum >= last or sum == math.huge then break end
      nodes, u = corrected(state, step, nodes, u, defect, missing)
      last = sum
    end
    part = part / 2
  end
  return false
end

local function size_of(x)
  local most = 0
  for k = 1, #x do most = math.max(most, math.abs(x[k])) end
  return most
end

local function take(state, evaluate)
  local there, why = evaluate(state.u, state.nodes, state.weights, state.multipliers)
  if not there then return nil, why end
  state.there = there
  state.defect, state.missing = gaps(state, state.nodes, there)
  for k = 1, state.knots - 1 do state.horizon:segment(k, there.J[k], there.H[k]) end
  for k = 1, state.knots do state.horizon:bend(k, there.bends[k]) end
  for i, goal in ipairs(state.goals) do state.horizon:goal(i, goal.knot, there.slopes[i]) end
  return true
end

local function new_state(options, u, nodes)
  local d = #nodes[1]
  return { u = u, n = #u, own = options.own, place = options.place, interval = options.interval, controls = options.controls,
    knots = options.knots, goals = options.goals, limits = ranges.of(options.goals), negligible = options.negligible,
    bounds = options.bounds,
    d = d, nodes = nodes, horizon = horizon.new(options.knots, d, options.controls, #options.goals, options.own and 0 or options.interval) }
end

-- At the states that are given, those of a scene that stands still, or the run's; or as a search that was interrupted left it.
local function begin(options)
  local saved = options.saved
  if saved then
    local state = new_state(options, saved.u, saved.nodes)
    for _, key in ipairs { "weights", "multipliers", "penalty", "price" } do state[key] = saved[key] end
    state.first = saved.iteration
    return state
  end
  local there, why = options.evaluate(options.start, nil, false)
  if not there then return nil, why end
  local nodes = { there.start }
  for k = 2, options.knots do
    nodes[k] = options.nodes and options.nodes[k] or options.guess == "still" and there.start or there.ends[k - 1]
  end
  local state = new_state(options, options.start, nodes)
  state.penalty, state.price = zeros(state.d), zeros(#state.goals)
  return state
end

-- By how much the controls move each goal, about; one that nothing moves as the others.
local function reach_of(state)
  local list, most = {}, 0
  for i, row in ipairs(state.A) do
    list[i] = math.sqrt(linear.dot(row, row) * linear.dot(state.u, state.u))
    most = math.max(most, list[i])
  end
  for i = 1, #list do list[i] = list[i] > 1e-12 * most and list[i] or most end
  return list
end

local function result(state, iterations, ended)
  if state.contradiction then return nil, nil, state.contradiction end
  return { u = state.u, nodes = state.nodes, cost = state.cost, iterations = iterations, ended = ended,
    reach = reach_of(state) }
end

-- options: start (u), interval (s, between knots), knots, controls (how many), goals { { value, or min and max, knot } }, those with
-- a value first, own (whether evaluate gives the cost, in the place of the controls' squares), evaluate(u, nodes, weights, multipliers) ->
-- { start, ends, J, H, goals, slopes, bends } (weights nil: without H; false: without J, H and slopes; nodes nil: those of the run;
-- bends, of knots: the goals' second derivatives times their multipliers, of those that are 0 nil; own: also cost and, with J, its slopes
-- by_controls and by_states and G, its second derivatives without those of steps, which are in H; along, with constraints: what projects
-- along them at every knot, tangents.lua), place(X) -> X on the constraints (nil: there are none), negligible, bounds, most, tolerance,
-- nodes (a guess of the states), guess (where there is none; "still": all as the first one; "run": those of the run),
-- note(iteration, cost, missing, u), save(state) before each iteration, with all that the rest of the search depends on beside these
-- options (iteration, u, nodes, weights, multipliers, penalty, price), and saved, such a state, from which it goes on. Returns what
-- common/optimise/sqp.lua returns, with u and nodes.
function transcription.minimise(options)
  local state, why = begin(options)
  if not state then return nil, why end
  local most = math.max(options.most, state.first or 1)
  for iteration = state.first or 1, most do
    local fine
    if options.save then
      options.save { iteration = iteration, u = state.u, nodes = state.nodes, weights = state.weights, penalty = state.penalty,
        price = state.price, multipliers = state.multipliers }
    end
    fine, why = take(state, options.evaluate)
    if not fine then return nil, why end
    local step = direction(state)
    if not step and not state.A then
      return nil, state.own and ("the cost has no least value near these controls, along some control it bends down or not at all: add "
        .. "a part that grows with each, such as its square, or take --way shooting") or "the quadratic program has no least value, "
        .. "whatever is added to it: begin with other controls, or --starts"
    end
    if not step then
      local c = table.move(state.missing, 1, state.limits.equal, 1, {})
      return nil, nil, state.contradiction or { row = state.limits:worst(table.move(state.there.goals, #c + 1, #state.goals, #c + 1, c)) }
    end
    weigh(state, step, step.equations)
    local missing = sum_of(state, state.defect, state.missing)
    local cost = cost_at(state, state.u, state.there)
    state.cost = cost
    if options.note then options.note(iteration, cost, missing, state.u) end
    local small = size_of(step.p) <= options.tolerance * math.max(size_of(state.u), 1e-300)
    if small and missing <= options.tolerance * math.max(math.abs(cost), 1e-300) and iteration > 1 then
      search(state, step, options.evaluate) -- what is left, too
      return result(state, iteration - 1, "converged")
    end
    if not search(state, step, options.evaluate) then return result(state, iteration, "a search without a way down") end
    state.weights, state.multipliers = step.equations, step.multipliers
  end
  return result(state, most, "as many iterations as --most")
end

return transcription
