-- The least effort by transcription: unknown are the controls and the states at all knots, and that the steps between two knots lead
-- from one to the next is an equation for each number (Bock and Plitt 1984: direct multiple shooting; on the integrator's own steps,
-- as Ober-Bloebaum, Junge and Marsden 2011 have them). Newton's method on the Lagrangian, with second derivatives of the
-- equations; its quadratic program, banded in time, is solved in as many operations as there are knots (tools/native/horizon.c);
-- goals and bounds by the dual method over that; a line search on the effort and what is missing of every equation.
local horizon = require("horizon")
local linear = require("common.fit.linear")
local quadratic = require("common.optimise.quadratic")

local transcription = {}

local most_halvings, most_corrections = 12, 2

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

local function effort_of(state, u) return linear.dot(u, effort_slope(state, u)) end

-- ---- one iteration ----

-- The goals in the controls: rows, and what is missing of them with the states that follow.
local function rows_of(state)
  local A, c, t = {}, {}, state.horizon:follow(nil, state.defect)
  for i, goal in ipairs(state.goals) do
    A[i], c[i] = state.horizon:row(i), state.missing[i] + linear.dot(state.there.slopes[i], t[goal.knot])
  end
  return A, c
end

-- Factors the matrix; where it is not positive the goals' squares are added, which change nothing where the goals are met, and make
-- it positive where it is along them, and at last a multiple of 1 for all changes, of states as well: without that a motion that
-- is not stable goes as far astray as controls are kept from turning it (Waechter and Biegler 2006, algorithm IC and its numbers).
-- nil: never; else whether that was added.
local function factor(state, A)
  if state.horizon:factor(0, 0) then return false end
  local size = 0
  for i = 1, #A do size = math.max(size, linear.dot(A[i], A[i])) end
  local weight = size > 0 and 100 * state.n * 4 / 3 * state.interval / size or 0
  for _ = 1, weight > 0 and 3 or 0 do
    if state.horizon:factor(weight, 0) then return false end
    weight = 30 * weight
  end
  weight = weight / 30 ^ 2
  local shift, grows = state.shift and math.max(state.shift / 3, 1e-20) or 1e-4, state.shift and 8 or 100
  while shift < 1e40 do
    if state.horizon:factor(weight, shift) then
      state.shift = shift
      return true
    end
    shift = grows * shift
  end
end

-- The step of the quadratic program.
local function direction(state)
  local A, c = rows_of(state)
  state.A = nil
  local shifted = factor(state, A)
  if shifted == nil then return nil end
  state.A = A
  local slope = effort_slope(state, state.u)
  slope = quadratic.add(slope, 1, slope)
  local least = state.horizon:least(slope, state.defect, state.missing)
  local step, contradiction = quadratic.solve(function(row) return state.horizon:image(row) end, slope, A, c, state.negligible,
    state.bounds and setmetatable({ at = state.u }, { __index = state.bounds }), least)
  state.contradiction = contradiction
  if not step then return nil end
  step.x, step.shifted = state.horizon:follow(step.p, state.defect), shifted
  return step
end

-- What is missing of every equation, at what evaluation there is.
local function miss(state, nodes, there)
  local defect, missing, sum = {}, {}, 0
  for k = 1, state.knots - 1 do
    defect[k] = quadratic.add(there.ends[k], -1, nodes[k + 1])
    for i = 1, state.d do sum = sum + state.penalty[i] * math.abs(defect[k][i]) end
  end
  for i, goal in ipairs(state.goals) do
    missing[i] = there.goals[i] - goal.value
    sum = sum + state.price[i] * math.abs(missing[i])
  end
  return defect, missing, sum
end

-- Weights above all multipliers, which fall slowly.
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

local function moved(state, step, part)
  local nodes = { state.nodes[1] }
  for k = 2, state.knots do nodes[k] = quadratic.add(state.nodes[k], part, step.x[k]) end
  return nodes, quadratic.add(state.u, part, step.p)
end

-- The nodes and controls from which what is missing there is taken back, by the derivatives that the step has: the correction of
-- second order, without which the merit forbids whole steps along bent equations (Maratos; Nocedal and Wright 18.3).
local function corrected(state, step, nodes, u, there)
  local defect, missing = miss(state, nodes, there)
  local t, by = state.horizon:follow(nil, defect), {}
  for i, goal in ipairs(state.goals) do by[i] = missing[i] + linear.dot(state.there.slopes[i], t[goal.knot]) end
  local none = zeros(state.n)
  local back = quadratic.add(none, -1, quadratic.back(step, by) or none)
  local change, list = state.horizon:follow(back, defect), { nodes[1] }
  for k = 2, state.knots do list[k] = quadratic.add(nodes[k], 1, change[k]) end
  return list, quadratic.add(u, 1, back)
end

-- Goes along the step as far as the merit falls; false: nowhere.
local function search(state, step, evaluate)
  local _, _, now = miss(state, state.nodes, state.there)
  local slope = 2 * linear.dot(effort_slope(state, state.u), step.p) - now
  local merit, part = effort_of(state, state.u) + now, 1
  for _ = 1, most_halvings do
    local nodes, u = moved(state, step, part)
    local last = math.huge
    for _ = 0, most_corrections do
      local there = evaluate(u, nodes)
      local sum = there and select(3, miss(state, nodes, there)) or math.huge
      if there and effort_of(state, u) + sum <= merit + 1e-4 * part * slope + 1e-13 * math.abs(merit) then
        state.nodes, state.u = nodes, u
        return part
      end
      if sum >= last or sum == math.huge then break end
      nodes, u = corrected(state, step, nodes, u, there)
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
  local there, why = evaluate(state.u, state.nodes, state.weights)
  if not there then return nil, why end
  state.there = there
  state.defect, state.missing = miss(state, state.nodes, there)
  for k = 1, state.knots - 1 do state.horizon:segment(k, there.J[k], there.H[k]) end
  for i, goal in ipairs(state.goals) do state.horizon:goal(i, goal.knot, there.slopes[i]) end
  return true
end

local function new_state(options, u, nodes)
  local d = #nodes[1]
  return { u = u, n = #u, interval = options.interval, controls = options.controls, knots = options.knots, goals = options.goals,
    negligible = options.negligible, bounds = options.bounds, d = d, nodes = nodes,
    horizon = horizon.new(options.knots, d, options.controls, #options.goals, options.interval) }
end

-- At the run of the first guess, or as a search that was interrupted left it.
local function begin(options)
  local saved = options.saved
  if saved then
    local state = new_state(options, saved.u, saved.nodes)
    state.weights, state.penalty, state.price, state.first = saved.weights, saved.penalty, saved.price, saved.iteration
    return state
  end
  local there, why = options.evaluate(options.start, nil, false)
  if not there then return nil, why end
  local nodes = { there.start }
  for k = 1, options.knots - 1 do nodes[k + 1] = there.ends[k] end
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
  return { u = state.u, cost = effort_of(state, state.u), iterations = iterations, ended = ended, reach = reach_of(state) }
end

-- options: start (u), interval (s, between knots), knots, controls (how many), goals { { value, knot } }, evaluate(u, nodes, weights) ->
-- { start, ends, J, H, goals, slopes } (weights nil or false: without H; nodes nil: those of the run), negligible, bounds, most,
-- tolerance, note(iteration, cost, missing, u), save(state) before each iteration, with all that the rest of the search depends on
-- beside these options (iteration, u, nodes, weights, penalty, price), and saved, such a state, from which it goes on. Returns what
-- common/optimise/sqp.lua returns, with u.
function transcription.minimise(options)
  local state, why = begin(options)
  if not state then return nil, why end
  for iteration = state.first or 1, options.most do
    local fine
    if options.save then
      options.save { iteration = iteration, u = state.u, nodes = state.nodes, weights = state.weights, penalty = state.penalty,
        price = state.price }
    end
    fine, why = take(state, options.evaluate)
    if not fine then return nil, why end
    local step = direction(state)
    if not step and not state.A then
      return nil, "the quadratic program has no least value, whatever is added to it: begin with other controls, or --starts"
    end
    if not step then return nil, nil, state.contradiction or { row = 1 } end
    local list = state.horizon:multipliers(step.x, step.p, step.multipliers)
    weigh(state, step, list)
    local _, _, missing = miss(state, state.nodes, state.there)
    local cost = effort_of(state, state.u)
    if options.note then options.note(iteration, cost, missing, state.u) end
    local small = size_of(step.p) <= options.tolerance * math.max(size_of(state.u), 1e-300)
    if small and missing <= options.tolerance * math.max(cost, 1e-300) and iteration > 1 then
      search(state, step, options.evaluate) -- what is left, too
      return result(state, iteration - 1, "converged")
    end
    if not search(state, step, options.evaluate) then return result(state, iteration, "a search without a way down") end
    state.weights = list
  end
  return result(state, options.most, "as many iterations as --most")
end

return transcription
