-- What goals are with given controls, and how they change with the values at the knots: a run of the scene, and one adjoint
-- for each goal, in a process of its own.
local case_process = require("common.run.case_process")
local derivative = require("common.gradient.derivative")

local evaluation = {}

-- The derivatives of every goal, by the values of all controls one after the other; or nil and why.
local function slopes_of(case, record)
  local list = {}
  for g, goal in ipairs(case.goals) do
    local why = case.careful and record:refusal(goal.name)
    if why then return nil, ("the measure '%s': %s"):format(goal.name, why) end
    local by_control
    by_control, why = record:adjoint(goal.name)
    if not by_control then return nil, why end
    list[g] = {}
    for _, slopes in ipairs(by_control) do table.move(slopes, 1, #slopes, #list[g] + 1, list[g]) end
  end
  return list
end

local function begin_record(case, run)
  local record, why = require("sensitivity").record(run)
  if not record then return nil, why end
  local both
  both, why = derivative.vary(case, record)
  if not both then return nil, why end
  return record
end

local function execute(case)
  local scene, run = derivative.open(case, 0, 0)
  if not scene then return { failed = run } end
  local record, why
  if case.gradient then
    record, why = begin_record(case, run)
    if not record then return { failed = why } end
  end
  run, why = derivative.advance(scene, case.at)
  if not run then return { failed = why } end
  local result, measures = { misses = {}, dt = run:summary().dt_max, integrator = run:summary().integrator }, run:measures()
  for g, goal in ipairs(case.goals) do
    if not measures[goal.name] then return { failed = ("the measure '%s' is not finite at the end"):format(goal.name) } end
    result.misses[g] = measures[goal.name] - goal.value
  end
  if not record then return result end
  local fine
  fine, why = record:finish()
  if not fine then return { failed = why } end
  result.slopes, why = slopes_of(case, record)
  return result.slopes and result or { failed = why }
end

-- case: scene, params, parameters (controls: name, duration, values), goals { { name, value } }, at, integrator, dt, seed,
-- trust; gradient: with slopes; careful: whether the measures can be differentiated is tried.
-- Returns { misses = { value - goal }, slopes = { { by each value }, ... }, dt } or { failed }.
function evaluation.take(case)
  case.execute, case.factor = execute, 1
  return case_process.run(case)
end

return evaluation
