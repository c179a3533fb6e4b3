-- Runs the methods (tools/common/bench/methods.lua) with increasing accuracy, in turns, so that each gets its share of
-- the time. A method ends when its errors are below the requested ones or no longer decrease, when its next run would
-- take longer than its share of the remaining time, or when it cannot run the scene. Then methods that may be the best at
-- the target are run with settings that just reach it. All times are of the processor, so that what else the machine
-- does changes nothing.
local accuracy_search = require("common.bench.accuracy_search")
local methods = require("common.bench.methods")
local process = require("process")

local refinement = {}

local enough_rows, most_failures = 3, 5
local start_seconds = 0.2 -- upper bound for the start of a process and its scene, until one has been seen
local may_win = 2         -- relative to the cheapest at the target: what is expected to cost more is not settled
local short_repeats = 0.02 -- s, for the repeats of short runs: less than what a process takes to start
local most_first = 3      -- relative to its share: what the first run of a method is expected to cost at most
local most_settled = 2    -- runs to settle a method at the target
local small = 0.01 -- relative to the motion's size: larger errors may still decrease

local function row_of(method, setting, case, result)
  local row = { method = method, integrator = method.label, setting = setting, case = case, result = result,
    verdict = result.verdict or "failed", reason = result.failed or result.reason,
    times = result.times or { result.step_s } }
  if result.step_s and #row.times > 0 then row.wall_s = math.min(table.unpack(row.times)) end
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

-- Whether a method may still improve. An adaptive method whose steps are limited by the frames takes the same steps for
-- several tolerances, which does not end it.
local function may_improve(row, before)
  return row.error < 0.8 * before.error or row.result.steps < 1.1 * before.result.steps
end

-- The reason why a method ends after this row, or nil.
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
  local stalled = before and second and good(before) and good(second) and not may_improve(row, before)
    and not may_improve(before, second) and row.error < small * goal.scale
  return stalled and "its errors no longer fall" or nil
end

-- The least cost of an explicit method's first run, by its evaluations, each as in the cheapest run so far; nil: not known.
local function least_first(method, setting, list, seconds)
  local h = setting.dt or method.longest -- an adaptive method's steps are no longer than stable ones
  if method.implicit or setting.substeps or h == math.huge then return nil end
  local each
  for _, other in ipairs(list) do
    local row = not other.implicit and other.rows[1]
    if row and row.wall_s and (row.result.force_evaluations or 0) > 0 then
      each = math.min(each or math.huge, row.wall_s / row.result.force_evaluations)
    end
  end
  return each and each * method.stages * seconds / h
end

local function next_run(method, list, goal, share)
  local setting = methods.setting(method, method.level, goal.fps)
  if not setting then return nil, "the end of its ladder" end
  local last = method.rows[#method.rows]
  if not last then
    local least = least_first(method, setting, list, goal.seconds)
    if least and least > most_first * share then return nil, "its stable steps would take too long" end
    return setting
  end
  local predicted = (last.result.step_s or last.result.process_s) * methods.growth(method)
  local extra = last.error and last.error <= goal.finest -- further rows only show the order
  if predicted > (extra and 0.3 or 1) * share then return nil, "the next run would take too long" end
  return setting
end

local function take(method, setting, bench, goal, share)
  local case = bench.case(method.params)
  case.integrator, case.dt, case.tol = setting.integrator, setting.dt, setting.tol
  case.against, case.repeats, case.repeat_s = goal.motion, 6, math.max(math.min(0.05, 0.1 * share), short_repeats)
  case.allowance = 1.2 * share + (bench.start_s or start_seconds)
  local result
  bench.run({ case }, function(_, r) result = r end, 1)
  if result.fits == false then return nil, result.failed end
  local row = row_of(method, setting, case, result)
  row.error = error_of(row, goal.metric)
  if result.processor_s and result.times then
    local timed = 0
    for _, time in ipairs(result.times) do timed = timed + time end
    bench.start_s = math.max(bench.start_s or 0, 2 * (result.processor_s - timed))
  end
  return row
end

-- The approximate cost of a method's first run relative to the others of its kind.
local function relative_cost(method) return method.stages / math.min(method.longest, 1) end

-- The methods in the order of their first runs. Explicit ones are sure to finish and come first; where only the best is
-- looked for, explicit and implicit ones take turns, so that neither kind is left out when the time is over.
local function in_order(list, goal)
  local order, turn = table.move(list, 1, #list, 1, {}), {}
  table.sort(order, function(a, b)
    local x, y = relative_cost(a), relative_cost(b)
    return x < y or x == y and a.label < b.label
  end)
  local count = { [true] = 0, [false] = 0 }
  for _, method in ipairs(order) do
    local implicit = not not method.implicit
    count[implicit] = count[implicit] + 1
    turn[method] = goal.only_best and 2 * count[implicit] + (implicit and 1 or 0) or (implicit and #list or 0) + count[implicit]
  end
  table.sort(order, function(a, b) return turn[a] < turn[b] end)
  return order
end

-- A row takes its place by its work.
local function insert(method, row)
  local at = #method.rows + 1
  while at > 1 and methods.work(method.rows[at - 1].setting) > methods.work(row.setting) do at = at - 1 end
  table.insert(method.rows, at, row)
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
-- below it cannot be resolved), target, only_best (runs that are slower than the best at the target need not finish) };
-- seconds for all. Sets method.rows, method.refused (the reason why it does not fit the scene) and method.ended (the
-- reason why there are no more rows).
function refinement.run(list, bench, goal, seconds)
  local begun, live = process.processor_time(), in_order(list, goal)
  for _, method in ipairs(list) do method.level = 0 end
  while #live > 0 do
    local going = {}
    for k, method in ipairs(live) do
      local left = seconds - (process.processor_time() - begun)
      local share = math.max(left, 0) / (#live - k + 1 + #going)
      if goal.only_best then share = math.min(share, cheapest_at_target(list, goal)) end
      local setting, why = next_run(method, list, goal, share)
      if goal.only_best and left <= 0 and cheapest_at_target(list, goal) < math.huge then
        setting, why = nil, "no time was left"
      end
      local row
      if setting then row, why = take(method, setting, bench, goal, share) end
      if row then
        method.rows[#method.rows + 1], method.level = row, method.level + 1
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

-- The method of the list that is expected to be the cheapest at the target with a setting that was not run.
local function next_to_settle(list, goal)
  local best, cheapest = nil, cheapest_at_target(list, goal)
  for _, method in ipairs(list) do
    local s = (method.settled or 0) < most_settled and accuracy_search.cheapest(method, goal, math.max(goal.target, goal.support))
    if s and s.expected and s.wall < may_win * cheapest and (not best or s.wall < best.wall) then best = s end
  end
  return best
end

-- Runs methods of the list with settings that are expected to just reach the target, for so many seconds.
function refinement.settle(list, bench, goal, seconds)
  local begun = process.processor_time()
  while true do
    local left = seconds - (process.processor_time() - begun)
    local s = next_to_settle(list, goal)
    if not s or 1.5 * s.wall > left then return end
    local row = take(s.method, s.setting, bench, goal, 2 * s.wall)
    s.method.settled = (s.method.settled or 0) + 1
    if row then insert(s.method, row) end
  end
end

-- Repeats the timing of rows, in turns, until each has `count` times or the seconds are over.
function refinement.repeat_rows(rows, bench, count, seconds)
  local begun = process.processor_time()
  for turn = 2, count do
    for _, row in ipairs(rows) do
      local left = seconds - (process.processor_time() - begun)
      if #row.times < turn and (row.result.processor_s or 0) < left then
        local case = bench.case(row.case.varied)
        case.integrator, case.dt, case.tol = row.case.integrator, row.case.dt, row.case.tol
        case.allowance, case.turn, case.repeats = 4 * (row.result.processor_s or 0) + 1, turn, 1
        bench.run({ case }, function(_, r) row.times[#row.times + 1] = r.times and r.times[1] or r.step_s end, 1)
        row.wall_s = math.min(table.unpack(row.times))
      end
    end
  end
end

return refinement
