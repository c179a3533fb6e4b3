-- The least effort by transcription: unknown are the controls and the states at all knots, and that the steps between two knots lead
-- from one to the next is an equation for each number (Bock and Plitt 1984: direct multiple shooting; on the integrator's own steps,
-- as Ober-Bloebaum, Junge and Marsden 2011 have them). Newton's method on the Lagrangian, with second derivatives of the
-- equations; the states' changes are eliminated from the equations in the order of time, which leaves a quadratic program in the
-- controls; a line search on the effort and what is missing of every equation.
local linear = require("common.fit.linear")
local quadratic = require("common.optimise.quadratic")

local transcription = {}

local most_halvings, most_corrections = 12, 2

-- ---- small matrices: J by columns, d numbers each, one behind the other ----

local function times_columns(J, d, first, x, sum)
  for c = 1, #x do
    local part, at = x[c], (first + c - 2) * d
    if part ~= 0 then
      for i = 1, d do sum[i] = sum[i] + J[at + i] * part end
    end
  end
  return sum
end

local function times_transposed(J, d, first, count, weight)
  local product = {}
  for c = 1, count do
    local sum, at = 0, (first + c - 2) * d
    for i = 1, d do sum = sum + J[at + i] * weight[i] end
    product[c] = sum
  end
  return product
end

local function zeros(n)
  local x = {}
  for k = 1, n do x[k] = 0 end
  return x
end

-- Places of the values of all controls at knots k and k + 1, in the order of J's last columns.
local function places(state, k)
  local list = {}
  for j = 1, state.controls do
    list[2 * j - 1], list[2 * j] = (j - 1) * state.knots + k, (j - 1) * state.knots + k + 1
  end
  return list
end

-- ---- elimination ----

-- The changes of the states with the controls: T[k][c] of node k by control c (columns of d numbers, nil: none), and t[k] without.
local function eliminate(state)
  local d, T, t = state.d, { {} }, { zeros(state.d) }
  for k = 1, state.knots - 1 do
    local J, own, next_one = state.there.J[k], places(state, k), {}
    for c, column in pairs(T[k]) do next_one[c] = times_columns(J, d, 1, column, zeros(d)) end
    for e, c in ipairs(own) do
      next_one[c] = next_one[c] or zeros(d)
      for i = 1, d do next_one[c][i] = next_one[c][i] + J[(d + e - 1) * d + i] end
    end
    T[k + 1], t[k + 1] = next_one, table.move(state.defect[k], 1, d, 1, {})
    times_columns(J, d, 1, t[k], t[k + 1])
  end
  return T, t
end

-- Adds what the curvature of segment k is in the controls to H and g.
local function add_curvature(state, k, T, t, H, g)
  local d, C, own = state.d, state.there.H[k], places(state, k)
  local images = {}
  for c, column in pairs(T) do
    local image = zeros(d)
    for i = 1, d do
      for e = 1, d do image[i] = image[i] + C[i][e] * column[e] end
    end
    images[c] = image
  end
  local fixed = zeros(d)
  for i = 1, d do
    for e = 1, d do fixed[i] = fixed[i] + C[i][e] * t[e] end
  end
  for c, column in pairs(T) do
    g[c] = g[c] + linear.dot(column, fixed)
    for b, image in pairs(images) do H[c][b] = H[c][b] + linear.dot(column, image) end
    for e, b in ipairs(own) do
      local cross = 0
      for i = 1, d do cross = cross + column[i] * C[i][d + e] end
      H[c][b], H[b][c] = H[c][b] + cross, H[b][c] + cross
    end
  end
  for e, b in ipairs(own) do
    for i = 1, d do g[b] = g[b] + C[i][d + e] * t[i] end
  end
end

-- The goals in the controls: rows, and what is missing of them with the states that follow.
local function rows_of(state, T, t)
  local A, c = {}, {}
  for i, goal in ipairs(state.goals) do
    local slope, row = state.there.slopes[i], zeros(state.n)
    for b, column in pairs(T[goal.knot]) do row[b] = linear.dot(slope, column) end
    A[i], c[i] = row, state.missing[i] + linear.dot(slope, t[goal.knot])
  end
  return A, c
end

-- The inverse of H + shift where that is positive; or nil.
local function inverse(H, shift)
  local n, L, B = #H, {}, {}
  for i = 1, n do
    local row = {}
    for k = 1, i do
      local sum, other = H[i][k] + (i == k and shift[i] or 0), L[k] or row
      for e = 1, k - 1 do sum = sum - row[e] * other[e] end
      if i == k then
        if sum <= 1e-12 * math.abs(H[i][i]) or sum ~= sum then return nil end
        row[i] = math.sqrt(sum)
      else row[k] = sum / other[k] end
    end
    L[i] = row
  end
  for c = 1, n do
    local x = zeros(n)
    for i = c, n do
      local sum, row = i == c and 1 or 0, L[i]
      for k = c, i - 1 do sum = sum - row[k] * x[k] end
      x[i] = sum / row[i]
    end
    for i = n, 1, -1 do
      local sum = x[i]
      for k = i + 1, n do sum = sum - L[k][i] * x[k] end
      x[i] = sum / L[i][i]
    end
    B[c] = x
  end
  return B
end

-- ---- one iteration ----

-- H and g of the effort u^T W u: W by columns.
local function effort(state)
  local H, g = {}, {}
  for i = 1, state.n do
    H[i] = {}
    for k = 1, state.n do H[i][k] = 2 * state.W[i][k] end
  end
  for i = 1, state.n do g[i] = linear.dot(H[i], state.u) end
  return H, g
end

-- Adds the goals' squares, such that they outweigh H: nothing changes where the goals are met, and H is positive where it is
-- along them.
local function add_goals(H, g, A, c)
  local most, size = 0, 0
  for i = 1, #H do most = math.max(most, math.abs(H[i][i])) end
  for i = 1, #A do size = math.max(size, linear.dot(A[i], A[i])) end
  local weight = size > 0 and 100 * most * #H / size or 0
  for i = 1, #A do
    for b = 1, #H do
      local part = weight * A[i][b]
      g[b] = g[b] + part * c[i]
      for k = 1, #H do H[b][k] = H[b][k] + part * A[i][k] end
    end
  end
end

-- The inverse of H, to which a multiple of the effort's own is added where it is not positive; or nil. Whether it was added.
local function positive_inverse(state, H, g, A, c)
  local shift = zeros(state.n)
  local B = inverse(H, shift)
  if B then return B, false end
  add_goals(H, g, A, c)
  for try = 0, 30 do
    B = inverse(H, shift)
    if B then return B, try > 0 end
    for i = 1, state.n do shift[i] = 2 * state.W[i][i] * 0.25 * 2 ^ try end
  end
end

-- The step of the quadratic program.
local function direction(state)
  local T, t = eliminate(state)
  local H, g = effort(state)
  local A, c = rows_of(state, T, t)
  if state.weights then
    for k = 1, state.knots - 1 do add_curvature(state, k, T[k], t[k], H, g) end
  end
  local B, shifted = positive_inverse(state, H, g, A, c)
  if not B then return nil end
  local step, contradiction = quadratic.solve(B, g, A, c, state.negligible, state.bounds and setmetatable({ at = state.u },
    { __index = state.bounds }))
  state.contradiction = contradiction
  if not step then return nil end
  state.A = A
  step.T, step.x, step.shifted = T, { state.nodes[1] }, shifted
  for k = 2, state.knots do
    local change = t[k]
    for b, column in pairs(T[k]) do change = quadratic.add(change, step.p[b], column) end
    step.x[k] = change
  end
  return step
end

-- The multipliers of all equations, from the last one back: of segment k behind it.
local function multipliers(state, step)
  local d, list = state.d, {}
  local behind = zeros(d)
  for k = state.knots - 1, 1, -1 do
    for i, goal in ipairs(state.goals) do
      if goal.knot == k + 1 then behind = quadratic.add(behind, step.multipliers[i], state.there.slopes[i]) end
    end
    list[k] = behind
    local before = times_transposed(state.there.J[k], d, 1, d, behind)
    if state.weights and k > 1 then
      local C, own = state.there.H[k], places(state, k)
      for i = 1, d do
        for e = 1, d do before[i] = before[i] + C[i][e] * step.x[k][e] end
        for e, b in ipairs(own) do before[i] = before[i] + C[i][d + e] * step.p[b] end
      end
    end
    behind = before
  end
  return list
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

local function effort_of(state, u)
  local sum = 0
  for i = 1, state.n do sum = sum + u[i] * linear.dot(state.W[i], u) end
  return sum
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
  local t, by = { zeros(state.d) }, {}
  for k = 1, state.knots - 1 do t[k + 1] = times_columns(state.there.J[k], state.d, 1, t[k], defect[k]) end
  for i, goal in ipairs(state.goals) do by[i] = missing[i] + linear.dot(state.there.slopes[i], t[goal.knot]) end
  local back = quadratic.back(step, by) or zeros(state.n)
  local list = { nodes[1] }
  for k = 2, state.knots do
    list[k] = quadratic.add(nodes[k], 1, t[k])
    for b, column in pairs(step.T[k]) do list[k] = quadratic.add(list[k], -back[b], column) end
  end
  return list, quadratic.add(u, -1, back)
end

-- Goes along the step as far as the merit falls; false: nowhere.
local function search(state, step, evaluate)
  local _, _, now = miss(state, state.nodes, state.there)
  local slope = 2 * linear.dot(quadratic.times(state.W, state.u), step.p) - now
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
  return true
end

-- As a search that was interrupted left it.
local function taken_up(options, saved)
  return { u = saved.u, n = #saved.u, W = options.W, controls = options.controls, knots = options.knots, goals = options.goals,
    negligible = options.negligible, bounds = options.bounds, d = #saved.nodes[1], nodes = saved.nodes, weights = saved.weights,
    penalty = saved.penalty, price = saved.price, first = saved.iteration }
end

local function begin(options)
  local saved = options.saved
  if saved then return taken_up(options, saved) end
  local there, why = options.evaluate(options.start, nil, false)
  if not there then return nil, why end
  local state = { u = options.start, n = #options.start, W = options.W, controls = options.controls, knots = options.knots,
    goals = options.goals, negligible = options.negligible, bounds = options.bounds, d = #there.start, nodes = { there.start } }
  for k = 1, state.knots - 1 do state.nodes[k + 1] = there.ends[k] end
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

-- options: start (u), W (of the effort u^T W u), knots, controls (how many), goals { { value, knot } }, evaluate(u, nodes, weights) ->
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
    if not step then return nil, nil, state.contradiction or { row = 1 } end
    local list = multipliers(state, step)
    weigh(state, step, list)
    local _, _, missing = miss(state, state.nodes, state.there)
    local cost = effort_of(state, state.u)
    if options.note then options.note(iteration, cost, missing, state.u) end
    local small = size_of(step.p) <= options.tolerance * math.max(size_of(state.u), 1e-300)
    if small and missing <= options.tolerance * math.max(cost, 1e-300) and iteration > 1 then
      return result(state, iteration - 1, "converged")
    end
    if not search(state, step, options.evaluate) then return result(state, iteration, "a search without a way down") end
    state.weights = list
  end
  return result(state, options.most, "as many iterations as --most")
end

return transcription
