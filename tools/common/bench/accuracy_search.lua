-- The setting with which a method just reaches an error, from the errors of its rows. Between two rows, one above and
-- one below the error, log error is linear in the work, the logarithm of 1/step, of the substeps, or of 1/tolerance; beyond
-- the most accurate row it goes on as between the last two, but no steeper than the method's order, and as that where
-- there is one row alone.
--
-- Without this a comparison would hang on luck: settings of a list that halves steps cost up to twice what is needed.
local methods = require("common.bench.methods")

local accuracy_search = {}

local aim = 0.85             -- of the error asked for, as the interpolation is not exact
local least_fall = 1.4       -- of the error between two rows, for these to show how it goes on
local most_further = 32      -- how many times the work of the last row an extrapolated setting may take
local most_decades = 4       -- and how much smaller its tolerance may be

local function has_error(row)
  return row.error and row.error == row.error and row.wall_s and (row.verdict == "ok" or row.verdict == "inaccurate")
end

local function reaches(row, goal, target)
  return row.verdict == "ok" and math.max(row.error, goal.support) <= target
end

-- Rows that show how the error falls: each takes more steps than the one before (a tolerance may have no effect).
local function falling(method)
  local rows = {}
  for _, row in ipairs(method.rows) do
    local last = rows[#rows]
    if has_error(row) and row.error > 0 and (not last or row.result.steps ~= last.result.steps or row.setting.substeps) then
      rows[#rows + 1] = row
    end
  end
  return rows
end

-- The last row above the error and the cheapest one that reaches it; nil where there is none.
local function bracket(method, goal, target)
  local above, below
  for _, row in ipairs(method.rows) do
    if has_error(row) then
      if reaches(row, goal, target) then
        if not below or row.wall_s < below.wall_s then below = row end
      elseif not below then
        above = row
      end
    end
  end
  return above, below
end

-- The row's cost with `work` more work: in proportion to it, of tolerances as the method's order says or two rows show.
local function cost(method, row, work, other)
  local exponent = 1
  if row.setting.tol then
    exponent = 1 / math.max(method.order, 1)
    local apart = other and methods.work(other.setting) - methods.work(row.setting)
    if apart and apart ~= 0 then exponent = math.log(other.wall_s / row.wall_s) / apart end
  end
  return row.wall_s * math.exp(exponent * work)
end

-- A run that was ended, with no more work, says that this one takes longer.
local function not_less_than_ended(method, s)
  for _, row in ipairs(method.rows) do
    if row.verdict == "timeout" and methods.work(row.setting) <= methods.work(s.setting) + 1e-9 then
      s.wall = math.max(s.wall, row.case.allowance)
    end
  end
  return s
end

local function was_run(method, setting)
  for _, row in ipairs(method.rows) do
    if has_error(row) and math.abs(methods.work(row.setting) - methods.work(setting)) < 1e-9 then return true end
  end
  return false
end

local function between(method, goal, target, above, below)
  local u, v = methods.work(above.setting), methods.work(below.setting)
  local part = math.log(above.error / (aim * target)) / math.log(above.error / math.max(below.error, goal.support, 1e-300))
  local work = u + (v - u) * math.min(math.max(part, 0), 1)
  local setting = methods.at_work(method, work, goal.fps)
  if not (methods.work(setting) > u and methods.work(setting) < v - 1e-9) or was_run(method, setting) then return nil end
  return not_less_than_ended(method, { method = method, setting = setting, row = below, error = aim * target,
    wall = cost(method, above, methods.work(setting) - u, below), expected = true })
end

local function beyond(method, goal, target)
  local rows = falling(method)
  local one, two = rows[#rows - 1], rows[#rows]
  if not two or one and one.error < least_fall * two.error or two.error <= math.max(goal.support, aim * target) then
    return nil -- it reaches the error, but something else is wrong with the run
  end
  local slope = two.setting.tol and 1 or method.order
  if one then
    local apart = methods.work(two.setting) - methods.work(one.setting)
    slope = math.min(math.log(one.error / two.error) / apart, slope)
  end
  local work = math.log(two.error / (aim * target)) / slope
  if work > (two.setting.tol and most_decades * math.log(10) or math.log(most_further)) then return nil end
  local setting = methods.at_work(method, methods.work(two.setting) + work, goal.fps)
  local more = methods.work(setting) - methods.work(two.setting)
  return not_less_than_ended(method, { method = method, setting = setting, row = two, error = aim * target,
    wall = cost(method, two, more), expected = true, extrapolated = true })
end

-- The cheapest setting of a method for an error: { method, setting, wall (s), error, row (the nearest one measured),
-- expected (true: not measured), extrapolated }; nil: it is not known.
function accuracy_search.cheapest(method, goal, target)
  local above, below = bracket(method, goal, target)
  if not below then return beyond(method, goal, target) end
  return above and between(method, goal, target, above, below)
    or { method = method, setting = below.setting, wall = below.wall_s, row = below, error = math.max(below.error, goal.support) }
end

return accuracy_search
