-- The scene cut at the knots of its controls, in a process of its own: what the steps between two knots make of a state at the
-- first one, how that depends on the state and on the values at both knots, and goals with their derivatives.
local case_process = require("common.run.case_process")
local derivative = require("common.gradient.derivative")

local segments = {}

local curved = 1e-4 -- of a number's size: the reach of differences of derivatives, eps^(1/4)

-- Which steps lie between two knots: { { first, last }, ... }; or nil and why that cannot be said.
local function cut(case, times)
  local list, control, at = {}, case.parameters[1], 1
  local count, h = #control.values - 1, times[2] - times[1]
  for k = 1, count do
    local wanted, first = k / count * control.duration, at
    while at < #times and times[at] < wanted - 1e-6 * h do at = at + 1 end
    if math.abs(times[at] - wanted) > 1e-6 * h then
      return nil, ("the knot at %.9g s lies within a step, from %.9g s: other knots, fps or --dt"):format(wanted, times[at - 1])
    end
    list[k] = { first = first, last = at - 1 }
  end
  return list
end

local function begin(case)
  local scene, run = derivative.open(case, 0, 0)
  if not scene then return nil, run end
  local record, why = require("sensitivity").record(run)
  if not record then return nil, why end
  local both
  both, why = derivative.vary(case, record)
  if not both then return nil, why end
  run, why = derivative.advance(scene, case.at)
  if not run then return nil, why end
  local fine
  fine, why = record:finish()
  return fine and record, why, run:summary().dt_max, both
end

-- Of the weighted sum of a segment's numbers the second derivatives: rows by the state, columns as those of J.
local function curvature(record, part, X, J, weight)
  local n, H, columns = #X, {}, #J // #X
  for e = 1, n do
    local by, sides = curved * math.max(math.abs(X[e]), 1), {}
    for side = -1, 1, 2 do
      local there = table.move(X, 1, n, 1, {})
      there[e] = X[e] + side * by
      local _, slopes = record:segment(part.first, part.last, there, true)
      if not _ then return nil, slopes end
      sides[side] = slopes
    end
    H[e] = {}
    for c = 1, columns do
      local sum = 0
      for i = 1, n do sum = sum + weight[i] * (sides[1][(c - 1) * n + i] - sides[-1][(c - 1) * n + i]) end
      H[e][c] = sum / (2 * by)
    end
  end
  return H
end

local function execute(case)
  local record, why, dt, kept = begin(case)
  if not record then return { failed = why } end
  local times, X = record:times()
  local parts
  parts, why = cut(case, times)
  if not parts then return { failed = why } end
  local result = { dt = dt, start = X, ends = {}, J = {}, H = {}, goals = {}, slopes = {}, kept = #kept }
  for k, part in ipairs(parts) do
    local slopes
    local from = case.nodes and case.nodes[k] or result.ends[k - 1] or X
    result.ends[k], slopes = record:segment(part.first, part.last, from, case.gradient)
    if not result.ends[k] then return { failed = slopes } end
    result.J[k] = case.gradient and slopes or nil
    if case.weights then
      result.H[k], why = curvature(record, part, from, slopes, case.weights[k])
      if not result.H[k] then return { failed = why } end
    end
  end
  for g, goal in ipairs(case.goals) do
    local node = goal.knot
    result.goals[g], result.slopes[g] = record:survey(goal.name, goal.at, case.nodes and case.nodes[node] or result.ends[node - 1])
    if not result.goals[g] then return { failed = result.slopes[g] } end
  end
  return result
end

-- case: as of common/optimise/evaluation.lua; goals with `knot`, at which they are; nodes: the states at the knots, or nil: the run's
-- own; weights: of the numbers behind each segment, for H. Returns { start, ends, J, H, goals (values), slopes, dt } or { failed }.
function segments.take(case)
  case.execute, case.factor = execute, 1
  return case_process.run(case)
end

return segments
