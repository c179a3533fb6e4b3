-- The whole run with a setting that a bench of its first part has led to, judged as `hooke run` judges it. Errors need not
-- add up evenly: an encounter, an impact or an instability may come after the part that was measured. Of settings that
-- might do, the cheapest is tried first; one whose error is too large comes back with as much more work as its order says.
local case_process = require("common.run.case_process")
local methods = require("common.bench.methods")

local trial = {}

local judged = case_process.execute -- that of a bench measures in another way

local check_costs = 3.5     -- a run and its comparisons with others, in runs
local start_seconds = 0.2   -- of a process
local most_trials = 10
local aim = 0.7             -- of the accuracy: what more work is to come to, and half of it after each failure
local untried = 0.1         -- the same, where no trial is left that could show it
local unknown = 2           -- times the work, where a run says only that it is wrong

local function expected(s, o) return start_seconds + check_costs * s.wall * o.times end

local function cheapest(list)
  local best
  for k, s in ipairs(list) do
    if not best or s.wall < list[best].wall then best = k end
  end
  return best and table.remove(list, best)
end

-- The same method with the work that its order asks for an error of `goal`; nil: there is no more.
local function refined(s, error, goal, o)
  local slope = s.setting.tol and 1 or math.max(s.method.order, 1)
  local too_large = error and error > o.accuracy and error < math.huge
  local more = too_large and math.log(error / goal) / slope or math.log(unknown)
  local setting = methods.at_work(s.method, methods.work(s.setting) + more, o.fps)
  more = methods.work(setting) - methods.work(s.setting)
  if more < 1e-6 then return nil end
  local costs = s.setting.tol and more / math.max(s.method.order, 1) or more
  return { method = s.method, setting = setting, wall = s.wall * math.exp(costs), row = s.row, error = goal,
    expected = true, refined = true, failures = (s.failures or 0) + 1 }
end

local function run(s, o, allowance)
  return case_process.run { scene = o.scene, params = o.params, trust = o.trust, integrator = s.setting.integrator,
    dt = o.step_of(s), tol = s.setting.tol, ["until"] = o.until_, accuracy = o.accuracy, allowance = allowance,
    execute = judged }
end

-- candidates: as those of accuracy_search.cheapest, with the cost of the part. o: scene, params, trust, until_, accuracy,
-- fps, budget (s of the processor), times (how many times the part the whole is), step_of(candidate). Returns the first that
-- is ok over the whole run, and the number of trials; nil where none was within the budget, with the one that came nearest.
function trial.first_ok(candidates, o)
  local list, left, count, nearest = table.move(candidates, 1, #candidates, 1, {}), o.budget, 0, nil
  while count < most_trials do
    local s = cheapest(list)
    if not s or expected(s, o) > left then break end
    local result = run(s, o, left)
    count, left = count + 1, left - result.processor_s
    if result.verdict == "ok" then return s, count end
    local error = result.error_estimate
    local goal = aim * 0.5 ^ (s.failures or 0) * o.accuracy
    local next_one = result.verdict ~= "timeout" and result.fits ~= false and refined(s, error, goal, o)
    if next_one then
      list[#list + 1] = next_one
      if error and (not nearest or error < nearest.error) then nearest = { candidate = s, error = error } end
    end
  end
  return nil, count, nearest and refined(nearest.candidate, nearest.error, untried * o.accuracy, o)
end

return trial
