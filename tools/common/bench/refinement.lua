-- Runs the methods (tools/common/methods.lua) down their ladders, in turns, so that each has had its share when the
-- time is over. A method ends when its errors are below what is asked or no longer fall, when its next run would take
-- longer than its share of the time that is left, or when the scene does not let it run.
local methods = require("common.bench.methods")
local process = require("process")

local refinement = {}

local enough_rows, most_failures = 3, 5
local start_seconds = 0.2 -- of a process and its scene, at most, where processors are shared
local small = 0.01 -- of the motion's size: larger errors may fall yet

local function median(list)
  local sorted = table.move(list, 1, #list, 1, {})
  table.sort(sorted)
  local middle = #sorted // 2
  return #sorted % 2 == 1 and sorted[middle + 1] or (sorted[middle] + sorted[middle + 1]) / 2
end

local function row_of(method, rung, case, result)
  local row = { method = method, integrator = method.label, rung = rung, case = case, result = result,
    verdict = result.verdict or "failed", reason = result.failed or result.reason,
    times = result.times or { result.step_wall_s } }
  if result.step_wall_s and #row.times > 0 then row.wall_s = median(row.times) end
  if result.error and not result.error.failed then row.errors = result.error end
  return row
end

-- The metric's value of a row; nil: not known.
local function error_of(row, metric)
  if metric == "energy" then
    local drift = row.result.energy and row.result.energy.drift
    return drift and math.abs(drift)
  end
  if not row.errors then return nil end
  if metric == "v" then return row.errors.v_rms end
  if metric == "x" then return row.errors.x_rms end
  return row.errors.measure[metric]
end
refinement.error_of = error_of

local function good(row)
  return row.error and row.error == row.error and (row.verdict == "ok" or row.verdict == "inaccurate")
end

-- An adaptive method whose steps the frames cut takes the same ones for several tolerances: that says nothing yet.
local function gains(row, before)
  return row.error < 0.8 * before.error or row.result.steps < 1.1 * before.result.steps
end

-- Why a method that has just done this row is at its end, or nil.
local function ended(method, row, goal)
  local rows = method.rows
  if not good(row) then
    method.failures = (method.failures or 0) + 1
    return method.failures >= most_failures and "it fails at every setting that was tried" or nil
  end
  method.failures = 0
  local before, second = rows[#rows - 1], rows[#rows - 2]
  if row.error <= goal.support then return "below what the reference supports" end
  if row.error <= goal.finest and #rows >= enough_rows then return "accurate enough" end
  local stalled = before and second and good(before) and good(second) and not gains(row, before)
    and not gains(before, second) and row.error < small * goal.scale
  return stalled and "its errors no longer fall" or nil
end

local function next_run(method, goal, share)
  local rung = methods.rung(method, #method.rows, goal.fps)
  if not rung then return nil, "the end of its ladder" end
  local last = method.rows[#method.rows]
  if not last then return rung end
  local predicted = (last.result.step_wall_s or last.result.process_s) * methods.growth(method)
  local extra = last.error and last.error <= goal.finest -- only to show the order
  if predicted > (extra and 0.3 or 1) * share then return nil, "the next run would take too long" end
  return rung
end

local function take(method, rung, bench, goal, share)
  local case = bench.case()
  case.integrator, case.dt, case.tol = rung.integrator, rung.dt, rung.tol
  case.against, case.repeats, case.repeat_s = goal.motion, 6, math.min(0.05, 0.1 * share)
  case.timeout = 1.2 * share + start_seconds
  local result
  bench.run({ case }, function(_, r) result = r end, 1)
  if result.fits == false then return nil, result.failed end
  local row = row_of(method, rung, case, result)
  row.error = error_of(row, goal.metric)
  method.rows[#method.rows + 1] = row
  return row
end

-- What a method's first run will cost beside the others', about: those that will end for sure go first.
local function expense(method)
  return (method.implicit and 1e9 or 0) + method.stages / math.min(method.longest, 1)
end

local function cheapest_at_target(list, goal)
  local best = math.huge
  for _, method in ipairs(list) do
    for _, row in ipairs(method.rows) do
      if row.verdict == "ok" and row.error and math.max(row.error, goal.support) <= goal.target and row.wall_s then
        best = math.min(best, row.wall_s)
      end
    end
  end
  return best
end

-- list: methods; bench as for reference.compute; goal: { metric, fps, motion (the reference), finest, support (errors
-- below mean nothing), target, only_best (what is slower than the best at the target need not end) }; seconds for all.
-- Fills method.rows, method.refused (why it does not fit the scene) and
-- method.ended (why there are no more rows).
function refinement.climb(list, bench, goal, seconds)
  local begun, live = process.clock(), table.move(list, 1, #list, 1, {})
  table.sort(live, function(a, b)
    local x, y = expense(a), expense(b)
    return x < y or x == y and a.label < b.label
  end)
  while #live > 0 do
    local going = {}
    for k, method in ipairs(live) do
      local left = seconds - (process.clock() - begun)
      local share = math.max(left, 0) / (#live - k + 1 + #going)
      if goal.only_best then share = math.min(share, cheapest_at_target(list, goal)) end
      local rung, why = next_run(method, goal, share)
      local row
      if rung then row, why = take(method, rung, bench, goal, share) end
      if row then
        method.ended = row.verdict == "timeout" and "it takes too long" or ended(method, row, goal)
      elseif #method.rows == 0 then
        method.refused = why
      else
        method.ended = why
      end
      if not method.ended and not method.refused then going[#going + 1] = method end
    end
    live = going
  end
end

-- Times rows again, in turns, until each has `count` times or the seconds are over.
function refinement.repeat_rows(rows, bench, count, seconds)
  local begun = process.clock()
  for turn = 2, count do
    for _, row in ipairs(rows) do
      local left = seconds - (process.clock() - begun)
      if #row.times < turn and row.result.process_s < left then
        local case = bench.case()
        case.integrator, case.dt, case.tol = row.case.integrator, row.case.dt, row.case.tol
        case.timeout, case.turn = 4 * row.result.process_s + 1, turn
        bench.run({ case }, function(_, r) row.times[#row.times + 1] = r.step_wall_s end, 1)
        row.wall_s = median(row.times)
      end
    end
  end
end

return refinement
