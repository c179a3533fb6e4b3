-- The scene cut at the knots of its controls, in a process of its own: what the steps between two knots make of a state at the
-- first one, how that depends on the state and on the values at both knots, and goals with their derivatives; and the search for the
-- least effort by transcription over these.
local case_process = require("common.run.case_process")
local curvature = require("common.optimise.curvature")
local derivative = require("common.gradient.derivative")
local frame_cost = require("common.optimise.frame_cost")
local linear = require("common.fit.linear")
local quadratic = require("common.optimise.quadratic")
local tangents = require("common.optimise.tangents")
local transcription = require("common.optimise.transcription")

local segments = {}

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

-- Which numbers of the state behind a segment move, where `moves` do before it and these are missing of the equations there: where
-- none of a segment's columns reaches, nothing ever comes from.
local function moved_behind(J, moves, defect)
  local n, behind = #moves, {}
  for i = 1, n do behind[i] = defect[i] ~= 0 end
  for c = 1, #J // n do
    if c > n or moves[c] then
      for i = 1, n do behind[i] = behind[i] or J[(c - 1) * n + i] ~= 0 end
    end
  end
  return behind
end

-- How far differences of slopes go: a part of the largest number of its kind, where slopes have errors of some 1e-10.
local part_of_slopes, same_slope = 1e-4, 1e-7

local function size_of(X, first, last)
  local most = 0
  for e = first, last do most = math.max(most, math.abs(X[e])) end
  return most > 0 and most or 1
end

-- A goal's measure at X, put onto the constraints if there are any, and its slope by X; or nil and why.
local function survey_at(record, goal, X, slopes)
  if record:curves() then return record:survey(goal.name, goal.at, X, slopes) end
  local there, D = record:place(X)
  if not there then return nil, D end
  local value, slope = record:survey(goal.name, goal.at, there, slopes)
  if not (value and slopes) then return value, slope end
  return value, tangents.back(D, slope)
end

-- The slope of a goal where every number of the state is beside X by its part of `by`.
local function slope_beside(record, goal, X, by)
  local value, slope = survey_at(record, goal, quadratic.add(X, 1, by), true)
  return value and slope, slope
end

-- Adds to `bend`, rows of squares, the second derivatives of a goal's measure at X times its price, by differences of its slope along
-- those numbers on which that depends; a slope that is the same where all numbers are others is that of a flat measure. Or nil and why.
local function add_bend(record, goal, X, slope, price, bend)
  local n, by, half = #X, {}, #X // 2
  local reach = { size_of(X, 1, half) * part_of_slopes, size_of(X, half + 1, n) * part_of_slopes }
  for e = 1, n do by[e] = reach[e > half and 2 or 1] * (0.5 + e * 0.6180339887 % 0.5) * (e % 2 == 0 and 1 or -1) end
  local there, why = slope_beside(record, goal, X, by)
  if not there then return nil, why end
  local change = quadratic.add(there, -1, slope)
  if size_of(change, 1, n) <= same_slope * size_of(slope, 1, n) or linear.dot(change, change) == 0 then return true end
  for e = 1, n do
    local far, more, less = reach[e > half and 2 or 1], nil, nil
    for i = 1, n do by[i] = i == e and far or 0 end
    if change[e] ~= 0 then
      more, why = slope_beside(record, goal, X, by)
      if not more then return nil, why end
      by[e] = -far
      less, why = slope_beside(record, goal, X, by)
      if not less then return nil, why end
    end
    for i = 1, more and n or 0 do
      local half_of = price * (more[i] - less[i]) / (4 * far)
      bend[(e - 1) * n + i] = bend[(e - 1) * n + i] + half_of
      bend[(i - 1) * n + e] = bend[(i - 1) * n + e] + half_of
    end
  end
  return true
end

-- The evaluation of common/optimise/transcription.lua, by a record whose controls are given other values.
local function evaluation_of(case, record, parts, start, own)
  local none = {}
  for e = 1, #start do none[e] = false end

  local function assign(u)
    local at = 0
    for j, control in ipairs(case.parameters) do
      local values = table.move(u, at + 1, at + #control.values, 1, {})
      local fine, why = record:assign(j, control.name, values, derivative.control_change(values))
      if not fine then return nil, why end
      at = at + #values
    end
    return true
  end

  local function survey(found, nodes, weights, prices)
    for g, goal in ipairs(case.goals) do
      local node = goal.knot
      local X = nodes and nodes[node] or found.ends[node - 1] or start
      found.goals[g], found.slopes[g] = survey_at(record, goal, X, weights ~= false)
      if not found.goals[g] then return nil, found.slopes[g] end
      if prices and prices[g] ~= 0 then
        local bend = found.bends[node] or {}
        for e = #bend + 1, #X * #X do bend[e] = 0 end
        local fine, why = add_bend(record, goal, X, found.slopes[g], prices[g], bend)
        if not fine then return nil, why end
        found.bends[node] = bend
      end
    end
    return found
  end

  -- The scene's own cost, in the place of the controls' squares.
  local function add_cost(found, u, from, curved, moved)
    local why
    if not found.J[1] then
      found.cost, why = own:value(from, found.ends)
      return found.cost and found, why
    end
    local sum
    sum, why = own:derive(u, from, found.ends, found.J, curved and moved or nil)
    if not sum then return nil, why end
    found.cost, found.G = sum.value, sum.G
    found.by_controls, found.by_states = own:by_knots(sum.slopes, #start)
    for k, C in ipairs(sum.C) do found.H[k] = found.H[k] and quadratic.add(found.H[k], 1, C) or C end
    return found
  end

  return function(u, nodes, weights, prices)
    local fine, why = assign(u)
    if not fine then return nil, why end
    local from_of, moved, curves = {}, {}, record:curves()
    local found = { start = start, ends = {}, J = {}, H = {}, goals = {}, slopes = {}, bends = {} }
    local slopes, moves = weights ~= false and nodes ~= nil, none
    for k, part in ipairs(parts) do
      local from = nodes and nodes[k] or found.ends[k - 1] or start
      from_of[k], moved[k] = from, moves
      local behind, J, H = record:segment(part.first, part.last, from, slopes, curves and weights and weights[k] or nil,
        moves)
      found.ends[k] = behind
      if not found.ends[k] then return nil, J end
      if slopes then
        found.J[k], found.H[k] = J, H
        moves = moved_behind(J, moves, quadratic.add(found.ends[k], -1, nodes[k + 1]))
      end
    end
    if nodes and not curves then
      found.along = {}
      for k = 2, #nodes do
        fine, found.along[k] = record:place(nodes[k])
        if not fine then return nil, found.along[k] end
      end
      weights = weights and tangents.multipliers(found.along, weights)
    end
    if weights and not curves then
      found.H, why = curvature.of { record = record, parts = parts, from = from_of, weights = weights, moves = moved, u = u,
        controls = #case.parameters, assign = assign }
      if not found.H then return nil, why end
    end
    if own then
      fine, why = add_cost(found, u, from_of, weights and curves, moved)
      if not fine then return nil, why end
    end
    for k, J in ipairs(found.along and found.J or {}) do found.J[k] = tangents.columns(found.along[k + 1], J, #start) end
    return survey(found, nodes, weights, prices)
  end
end

-- The whole search in one process: the scene and those beside it are made once, and steps taken from any state with any controls.
-- The child tells of every iteration, which is kept and shown outside of its sandbox.
local function execute(case, tell)
  local record, why, dt, kept = begin(case)
  if not record then return { failed = why } end
  local times, start = record:times()
  local parts
  parts, why = cut(case, times)
  if not parts then return { failed = why } end
  local options = setmetatable({}, { __index = case.options })
  why = case.cost and record:refusal(case.cost)
  if why then return { failed = ("the measure '%s': %s"):format(case.cost, why) } end
  options.evaluate = evaluation_of(case, record, parts, start, case.cost and frame_cost.of(case, record, times, parts))
  if not record:curves() then
    function options.place(X) return (record:place(X)) end
  end
  function options.note(...) tell { note = { ... } } end
  function options.save(state)
    state.dt = dt
    tell { save = state }
  end
  local result = { dt = dt, kept = #kept }
  result.optimum, result.failed, result.contradiction = transcription.minimise(options)
  return result
end

-- case: as of common/optimise/evaluation.lua (cost: in the place of the controls' squares);
-- goals with `knot`, at which they are; options: those of transcription.minimise without
-- evaluate. Returns { optimum, failed, contradiction, dt }.
function segments.minimise(case)
  case.execute, case.factor = execute, 1
  function case.told(message)
    if message.note then case.options.note(table.unpack(message.note)) end
    if message.save then case.options.save(message.save) end
  end
  return case_process.run(case)
end

return segments
