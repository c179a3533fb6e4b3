-- The scene cut at the knots of its controls, in a process of its own: what the steps between two knots make of a state at the
-- first one, how that depends on the state and on the values at both knots, and goals with their derivatives; and the search for the
-- least effort by transcription over these.
local case_process = require("common.run.case_process")
local derivative = require("common.gradient.derivative")
local quadratic = require("common.optimise.quadratic")
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

-- The evaluation of common/optimise/transcription.lua, by a record whose controls are given other values.
local function evaluation_of(case, record, parts, start)
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

  local function survey(found, nodes, weights)
    for g, goal in ipairs(case.goals) do
      local node = goal.knot
      found.goals[g], found.slopes[g] = record:survey(goal.name, goal.at,
        nodes and nodes[node] or found.ends[node - 1] or start, weights ~= false)
      if not found.goals[g] then return nil, found.slopes[g] end
    end
    return found
  end

  return function(u, nodes, weights)
    local fine, why = assign(u)
    if not fine then return nil, why end
    local found = { start = start, ends = {}, J = {}, H = {}, goals = {}, slopes = {} }
    local slopes, moves = weights ~= false and nodes ~= nil, none
    for k, part in ipairs(parts) do
      local from = nodes and nodes[k] or found.ends[k - 1] or start
      local behind, J, H = record:segment(part.first, part.last, from, slopes, weights and weights[k] or nil, moves)
      found.ends[k] = behind
      if not found.ends[k] then return nil, J end
      if slopes then
        found.J[k], found.H[k] = J, H
        moves = moved_behind(J, moves, quadratic.add(found.ends[k], -1, nodes[k + 1]))
      end
    end
    return survey(found, nodes, weights)
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
  options.evaluate = evaluation_of(case, record, parts, start)
  function options.note(...) tell { note = { ... } } end
  function options.save(state)
    state.dt = dt
    tell { save = state }
  end
  local result = { dt = dt, kept = #kept }
  result.optimum, result.failed, result.contradiction = transcription.minimise(options)
  return result
end

-- case: as of common/optimise/evaluation.lua; goals with `knot`, at which they are; options: those of transcription.minimise without
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
