-- The reference solution for errors: two different methods are refined until they agree to the requested accuracy.
-- Their difference is the reference's own error; only differences a hundred times larger are errors of another method.
-- Several methods start; then the two that agree best are refined, so that the pair suits the scene, stiff or not.
local methods = require("common.bench.methods")
local sampled_run = require("common.bench.sampled_run")
local process = require("process")

local reference = {}

reference.margin = 100 -- smallest ratio of an error to the reference's own, where the bench names none

-- Start values: the tolerance, or the divisor of the stable step (of implicit methods: of a frame).
local candidates = {
  { name = "dopri5", tol = 1e-7 },
  { name = "stoermer5", shorter = 2 },
  { name = "blanes_moan", shorter = 2 },
  { name = "rk4", shorter = 2 },
  { name = "esdirk4", tol = 1e-6 },
  { name = "cvode", settings = "method=bdf", tol = 1e-7 },
  { name = "tr_bdf2", tol = 1e-6 },
}
local tightest = 1e-14
local patience_at_first = 1   -- s, for the first runs of all
local shortest_patience = 0.1 -- s, where only two are wanted

local function case_of(c, level, bench)
  local case = bench.case()
  case.integrator = c.settings and c.name .. ":" .. c.settings or c.name
  case.motion, case.keep = true, true
  if c.tol then
    case.tol = c.tol / 10 ^ (level * (c.name == "tr_bdf2" and 2 or 1.5))
    if case.tol < tightest then return nil end
    return case
  end
  local longest = math.min(bench.step[c.name].suggestion, 1 / bench.fps)
  case.dt = 1 / (bench.fps * (math.ceil(1 / (bench.fps * longest) * (1 - 1e-12)) * c.shorter << level))
  return case
end

local function sound(result)
  return result.states and (result.verdict == "ok" or result.verdict == "inaccurate") and not result.failed
end

local function usable(c, bench)
  local step = bench.step[c.name]
  return step and (c.tol or step.limit > 0)
end

-- Runs one level of each method, for at most `timeout` s, while wanted() is true.
local function run(list, bench, timeout, wanted)
  local at = 0
  local function next_case()
    at = at + 1
    local c = list[at]
    if not c or wanted and not wanted() then return nil end
    local case = case_of(c, c.level, bench)
    case.owner, case.allowance = c, timeout
    return case
  end
  bench.run(next_case, function(case, result)
    local c = case.owner
    c.ended = not sound(result)
    c.late = result.verdict == "timeout"
    if c.ended then return end
    c.motion = { states = result.states, measures = result.motion.measures, t = result.motion.t,
      exact = result.motion.exact }
    c.case, c.time = case, result.step_s
    c.first = c.first or { case = case, motion = c.motion, time = c.time, verdict = result.verdict }
  end)
end

local function finished(list)
  local count = 0
  for _, c in ipairs(list) do count = count + (c.motion and 1 or 0) end
  return count
end

-- The time of one evaluation of f in s, from two frames of leapfrog; nil: it takes too long.
local function evaluation_time(bench)
  local case, seconds = bench.case(), nil
  case.integrator, case.allowance = "leapfrog", 1
  case["until"] = math.min(case["until"], 2 / bench.fps)
  bench.run({ case }, function(_, result)
    local count = result.force_evaluations or 0
    seconds = count > 0 and not result.failed and result.step_s / count or nil
  end)
  return seconds
end

-- Sets c.expected, the time in s that an explicit method takes, of the longest stable steps or shorter ones.
local function foretell(list, bench)
  local each = evaluation_time(bench)
  for _, c in ipairs(list) do
    local step = bench.step[c.name]
    local h = math.min(step.suggestion, 1 / bench.fps) / (c.shorter or 1)
    c.expected = each and not bench.implicit[c.name] and each * bench.stages[c.name] * bench.case()["until"] / h or nil
  end
end

-- Where runs are long, explicit methods that fit into half the time run first.
local function start_with_known(list, bench, left)
  local known = {}
  foretell(list, bench)
  for _, c in ipairs(list) do
    if c.expected and c.expected > patience_at_first / 2 and c.expected < left() / 4 then known[#known + 1] = c end
  end
  if #known >= 2 then run(known, bench, left() / 2, function() return finished(list) < 2 end) end
end

-- The two methods that are the first to come to the end: all have the same time, four times as much in every round, but
-- explicit methods do not begin before they can be expected to finish.
local function race(list, bench, left)
  local patience = shortest_patience
  local function wanted() return left() > 0 and finished(list) < 2 end
  foretell(list, bench)
  table.sort(list, function(a, b) return (a.expected or math.huge) < (b.expected or math.huge) end)
  while wanted() do
    local round, waiting = {}, 0
    for _, c in ipairs(list) do
      local open = not c.motion and (c.late or not c.ended)
      waiting = waiting + (open and 1 or 0)
      if open and (c.expected or 0) < patience then round[#round + 1] = c end
    end
    if waiting == 0 then return end
    run(round, bench, math.min(2 * patience, math.max(left(), 0.1)), wanted)
    patience = 4 * patience
  end
end

-- Runs the first level of all methods, with increasing time for those that have not finished, until two have.
local function start(list, bench, left)
  start_with_known(list, bench, left)
  local patience, waiting = patience_at_first, list
  local function wanted() return left() > 0 and (patience == patience_at_first or finished(list) < 2) end
  while #waiting > 0 and finished(list) < 2 and left() > 0 do
    run(waiting, bench, math.min(patience, math.max(left(), 0.1)), wanted)
    local late = {}
    for _, c in ipairs(list) do
      if c.late or c.motion == nil and not c.ended then late[#late + 1] = c end
    end
    waiting, patience = late, 4 * patience
  end
end

-- In a brief bench the cheaper of two methods is refined alone until it costs as much as the other one.
local function refine(list, bench, left)
  local finer, least = {}, math.huge
  for _, c in ipairs(list) do least = bench.brief and math.min(least, c.ended and math.huge or c.time) or least end
  for _, c in ipairs(list) do
    if bench.brief and c.time > 2 * least then goto continue end
    if not c.ended and case_of(c, c.level + 1, bench) then
      c.level = c.level + 1
      finer[#finer + 1] = c
    else
      c.ended = true
    end
    ::continue::
  end
  run(finer, bench, math.max(left(), 0.1))
end

local function value(difference, metric)
  if metric == "v" then return difference.v_rms end
  return difference.measure[metric] or difference.x_rms
end

-- The number of frames after the start until which two motions differ by at most `most`.
local function frames_within(difference, most, metric)
  local last = 0
  for k, x in ipairs(metric == "v" and difference.v or difference.x) do
    if x > most or x ~= x then break end
    last = k
  end
  return last
end

-- The two methods that agree for the longest time, and, of those that agree until the end, the two with the smallest
-- difference.
local function best_pair(list, metric, aim)
  local best, why
  for a = 1, #list do
    for b = a + 1, #list do
      local one, other, d = list[a], list[b], nil
      if one.motion and other.motion then d, why = sampled_run.compare(one.motion, other.motion) end
      local size = d and value(d, metric)
      if size and size == size then
        local pair = { one = one, other = other, difference = d, size = size, frames = frames_within(d, aim, metric) }
        if not best or pair.frames > best.frames or pair.frames == best.frames and size < best.size then best = pair end
      end
    end
  end
  return best, why
end

local function description(c)
  return ("%s, %s"):format(c.case.integrator, methods.setting_text(c.case))
end

-- The cheapest first run with a roughly correct motion: perturbations grow in it as they do in the scene.
local cheap_enough = 0.05 -- relative to the motion's size

local function cheapest(list, motion)
  local best, size
  local still = { states = {}, measures = motion.measures }
  for k in ipairs(motion.states) do still.states[k] = motion.states[1] end
  size = sampled_run.compare(still, motion).x_rms
  for _, c in ipairs(list) do
    local d = c.first and c.first.verdict == "ok" and sampled_run.compare(c.first.motion, motion)
    if d and (d.x_rms <= cheap_enough * size) and (not best or c.first.time < best.time) then best = c.first end
  end
  return best
end

-- bench: case() -> a new case; run(cases or next, done), many at a time; fps; metric; step = { [integrator] = of
-- hooke.explain }; stages and implicit = { [integrator] = of the catalogue }; brief (true: no finer than `aim` asks for).
-- aim: the largest allowed difference of the two, in the metric's unit; without `brief` they are refined further while
-- it costs little. seconds: the time available. Returns nil and the reason; or
--   motion         the solution; `other`: the second one
--   error          of its own, as sampled_run.compare gives it; size: of the metric
--   method         a cheap run with a roughly correct motion: { case, motion, time }
--   description    its two methods, as text
--   frames         until which they agree to `aim`; late: more time might have taken them further
function reference.compute(bench, aim, seconds)
  local begun, list = process.processor_time(), {}
  local function left() return seconds - (process.processor_time() - begun) end
  for _, c in ipairs(candidates) do
    if usable(c, bench) then
      list[#list + 1] = { name = c.name, settings = c.settings, tol = c.tol, level = bench.brief and c.tol and -1 or 0,
        shorter = bench.brief and 1 or c.shorter }
    end
  end
  local begin = bench.brief and race or start
  begin(list, bench, left)
  local pair, why = best_pair(list, bench.metric, aim)
  local stuck, late = 0, false
  if not pair and why then return nil, "no two methods can be compared: " .. why end
  if not pair then
    return nil, "no two methods came to the end of the scene in the time given: a larger --budget or a smaller "
      .. "--until may help"
  end
  while stuck < (bench.brief and 4 or 2) and pair.size > 0 and not (pair.one.ended and pair.other.ended) do
    local cheap = not bench.brief and process.processor_time() - begun < 0.15 * seconds -- then also for smaller errors
    if pair.size <= aim and not cheap then break end
    late = 2.5 * math.max(pair.one.time, pair.other.time) > left()
    if late then break end
    refine({ pair.one, pair.other }, bench, left)
    local better = best_pair(list, bench.metric, aim)
    local gained = better.size < pair.size / 1.5 or better.frames > 1.02 * pair.frames
    stuck = gained and 0 or stuck + 1
    pair = better
  end
  return { motion = pair.one.motion, other = pair.other.motion, error = pair.difference, size = pair.size,
    description = description(pair.one) .. " and " .. description(pair.other), late = late,
    method = cheapest(list, pair.one.motion) or pair.one, frames = pair.frames }
end

return reference
