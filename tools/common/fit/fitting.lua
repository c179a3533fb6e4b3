-- A fit: the least squares, with steps of the runs that are refined until they do not matter beside the data's own
-- deviations; several starts; what is known of the parameters then.
local least_squares = require("common.fit.least_squares")
local statistics = require("common.fit.statistics")

local fitting = {}

local most_levels = 6

local function size(p, scale, j) return math.max(math.abs(p[j]), scale[j]) end

-- The variance of a weighted residual: 1 where the data say their deviations, otherwise what is left of the residuals.
local function variance_of(state, o)
  local free = #state.r - #state.p
  if o.weighted then return 1 end
  return free > 0 and state.cost / free or 0 / 0
end

local function describe(state, o)
  local sizes = {}
  for j = 1, #state.p do sizes[j] = size(state.p, o.scale, j) end
  state.inverse, state.blind = statistics.inverse(state.J, sizes)
  state.sd, state.correlation = statistics.deviations(state.inverse, state.blind, variance_of(state, o))
end

-- How the residuals change with half the step; or nil and why it cannot be run.
local function change_of(state, o)
  local finer, why = o.runs:residuals({ state.p }, state.p, o.runs.level + 1)
  if not finer[1] then return nil, why[1] end
  local change = {}
  for k, r in ipairs(finer[1]) do change[k] = r - state.r[k] end
  return change
end

-- Whether the steps matter: beside the deviations, or where these are smaller the accuracy.
local function matters(state, o)
  for j, off in ipairs(state.by_steps) do
    local sd = state.sd[j] == state.sd[j] and state.sd[j] or 0
    if off > math.max(sd / 10, o.accuracy * size(state.p, o.scale, j)) then return true end
  end
  return false
end

-- Steps that adapt jump with the parameters, and errors with them by about the tolerance: the root of it is the step of
-- differences for which these jumps and the curvature do as much harm.
local function difference(o)
  return o.runs.adaptive and math.sqrt(o.runs:setting({}, o.runs.level).tol) or 1e-5
end

local function problem_of(start, o)
  local step = difference(o)
  return { start = start, low = o.low, high = o.high, scale = o.scale, difference = step,
    tolerance = o.runs.adaptive and math.max(o.tolerance, step / 10) or o.tolerance, most = o.most, note = o.note,
    evaluate = function(points, base) return o.runs:residuals(points, base) end }
end

-- Where the next level begins: moved by what half the step would do, where that is little.
local function moved(p, shift, o)
  local q = {}
  for j = 1, #p do
    local by = math.abs(shift[j]) < 0.1 * size(p, o.scale, j) and shift[j] or 0
    q[j] = math.min(math.max(p[j] + by, o.low[j]), o.high[j])
  end
  return q
end

-- o: runs, low, high, scale, tolerance and accuracy (relative), most, weighted, note(iteration, cost). From `start`: the state of the
-- least squares with sd, correlation, blind, level, change and shift (of the residuals and of p by half the step) and by_steps,
-- a bound of what the steps have done to p: twice the shift, which is 1 - 2^-order of it. Or nil and why.
function fitting.from(start, o)
  local total = 0
  for level = 0, most_levels do
    o.runs.level = level
    local state, why = least_squares.solve(problem_of(start, o))
    if not state then return nil, why end
    total = total + state.iterations
    state.iterations, state.level = total, level
    describe(state, o)
    state.change, state.unrefined = change_of(state, o)
    if not state.change then return state end
    state.shift, state.by_steps = statistics.shift(state.J, state.inverse, state.change), {}
    for j, shift in ipairs(state.shift) do state.by_steps[j] = 2 * math.abs(shift) end
    if not matters(state, o) then return state end
    if level == most_levels then
      state.unrefined = ("they still matter after %d halvings"):format(level)
      return state
    end
    start = moved(state.p, state.shift, o)
  end
end

-- Points of the sequence of Halton 1960 within the bounds, the first number of the sequence left out; on a logarithmic
-- scale where the bounds are positive and a factor of 100 or more apart.
function fitting.starts(count, low, high)
  local primes, list = { 2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37 }, {}
  for k = 1, count do
    list[k] = {}
    for j = 1, #low do
      local part, weight, n, base = 0, 1, k, primes[(j - 1) % #primes + 1]
      while n > 0 do
        weight = weight / base
        part = part + weight * (n % base)
        n = n // base
      end
      list[k][j] = low[j] > 0 and high[j] >= 100 * low[j] and low[j] * (high[j] / low[j]) ^ part
        or low[j] + part * (high[j] - low[j])
    end
  end
  return list
end

-- Whether two minima are one, to what the fit can tell.
function fitting.same(a, b, o)
  for j = 1, #a.p do
    local apart = math.abs(a.p[j] - b.p[j])
    local doubt = math.max(1e-4 * size(a.p, o.scale, j), a.sd[j] == a.sd[j] and a.sd[j] / 10 or math.huge)
    if apart > doubt then return false end
  end
  return true
end

return fitting
