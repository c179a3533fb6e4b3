-- What goals and the cost are with given controls, and how they change with the values at the knots: a run of the scene to every
-- time that has goals, and one adjoint for each goal, in a process of its own.
local case_process = require("common.run.case_process")
local derivative = require("common.gradient.derivative")

local evaluation = {}

-- One after the other what a list of lists has.
local function joined(lists)
  local all = {}
  for _, list in ipairs(lists) do table.move(list, 1, #list, #all + 1, all) end
  return all
end

local function begin_record(case, run)
  local record, why = require("sensitivity").record(run)
  if not record then return nil, why end
  local both
  both, why = derivative.vary(case, record)
  if not both then return nil, why end
  return record
end

-- The derivatives of a measure at the present time, or of its integral, by the values of all controls.
local function slopes_of(case, record, name, way)
  local why = case.careful and record:refusal(name)
  local by_control
  if not why then by_control, why = record[way](record, name) end
  if not by_control then return nil, ("the measure '%s': %s"):format(name, why) end
  return joined(by_control)
end

-- Takes the run to `to`; the integral of the cost over the frames until then, by the trapezium rule.
local function advance(case, scene, to)
  local sum, t, last = 0, 0, nil
  if case.cost then
    for k = 0, math.ceil(to * case.fps - 1e-6) do
      local now = math.min(k / case.fps, to)
      local run, why = derivative.advance(scene, now)
      local value = run and run:measures()[case.cost]
      if not value then return nil, why or ("the cost is not finite at t = %g s"):format(now) end
      if last then sum = sum + (last + value) / 2 * (now - t) end
      t, last = now, value
    end
  end
  local run, why = derivative.advance(scene, to)
  return run, run and sum or why
end

-- Adds what the goals at one time are to the result; or why not.
local function add_time(case, at, result)
  local part = setmetatable({ at = at }, { __index = case })
  local scene, run = derivative.open(part, 0, 0)
  if not scene then return run end
  local record, why
  if case.gradient then
    record, why = begin_record(part, run)
    if not record then return why end
  end
  local integral
  run, integral = advance(case, scene, at)
  if not run then return integral end
  local measures = run:measures()
  result.dt, result.integrator = run:summary().dt_max, run:summary().integrator
  if record then
    why = select(2, record:finish())
    if why then return why end
  end
  for g, goal in ipairs(case.goals) do
    if goal.at == at then
      if not measures[goal.name] then return ("the measure '%s' is not finite at %g s"):format(goal.name, at) end
      result.misses[g] = measures[goal.name] - (goal.value or 0)
      if record then
        result.slopes[g], why = slopes_of(case, record, goal.name, "adjoint")
        if why then return why end
      end
    end
  end
  if not case.cost or at ~= case.at then return nil end
  result.cost = integral
  if record then result.cost_slopes, why = slopes_of(case, record, case.cost, "integral") end
  return why
end

local function execute(case)
  local times, seen = {}, {}
  for _, goal in ipairs(case.goals) do
    if not seen[goal.at] then times[#times + 1], seen[goal.at] = goal.at, true end
  end
  if case.cost and not seen[case.at] then times[#times + 1] = case.at end
  table.sort(times)
  local result = { misses = {}, slopes = case.gradient and {} or nil }
  for _, at in ipairs(times) do
    local why = add_time(case, at, result)
    if why then return { failed = why } end
  end
  return result
end

-- case: scene, params, parameters (controls: name, duration, values), goals { { name, value (nil: one with a range), at } }, at (the end),
-- cost (the name of a measure, or nil), fps, integrator, dt, seed, trust; gradient: with slopes; careful: whether the measures can be
-- differentiated is tried. Returns { misses = { measure - value, of one with a range the measure }, slopes = { { by each value }, ... },
-- cost, cost_slopes, dt } or { failed }.
function evaluation.take(case)
  case.execute, case.factor = execute, 1
  return case_process.run(case)
end

return evaluation
