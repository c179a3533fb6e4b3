-- The derivative of a scene's measure by its parameters, by the derivative of the steps that a run takes
-- (tools/native/sensitivity.c), in a process of its own.
local case_process = require("common.run.case_process")
local parameters = require("common.run.parameters")

local derivative = {}

-- Differences by a parameter are taken with this part of a small change of it: linear forces leave rounding of
-- eps/7.6e-6 = 3e-11.
local part = 2 ^ -17 * 1e3
-- Forwards the first parameter costs 2 to 5 runs and each further one 0.5 to 2.3; backwards all of them cost 2 to 6
-- (tests/bench/sensitivity.c), and two evaluations a step each where it is no number of a force that gives derivatives by its
-- own, nor a mass. Forwards there is the course in time as well, so that some parameters are worth it.
derivative.most_forwards = 8
derivative.wider = 4 -- the differences of the second time
derivative.most = 64 -- at a time, tools/native/sensitivity.c

-- The text of a function of time (scripts/lib/control.lua), all of it larger by `by`.
function derivative.control_text(control, by)
  local list = {}
  for k, value in ipairs(control.values) do list[k] = ("%.17g"):format(value + by) end
  return ("%.17g: %s"):format(control.duration, table.concat(list, " "))
end

local function largest(values)
  local most = 0
  for _, value in ipairs(values) do most = math.max(most, math.abs(value)) end
  return most > 0 and most or 1
end

-- How far differences by a control with these values go.
function derivative.control_change(values) return largest(values) * 1e-3 * part end

-- How far the differences go; where that is beyond a bound, nil and why.
local function change_of(p, factor)
  if p.values then return derivative.control_change(p.values) * factor end
  local by = parameters.scale(p) * part * factor
  if p.start - by >= p.low and p.start + by <= p.high then return by end
  return nil, ("%s = %.9g is at its bound, where a derivative is one-sided: take a value %.2g inside"):format(p.name, p.start, by)
end

-- Whether differences of all widths that are taken stay within the bounds of the parameter.
function derivative.fits(p) return change_of(p, derivative.wider) ~= nil end

-- ---- in the process of a case ----

local function options_of(case)
  return { integrator = case.integrator, dt = case.dt or nil, tol = case.tol, seed = case.seed, trust = case.trust, threads = 1,
    output = false, without = case.without,
    ["until"] = case.at }
end

-- The scene with parameter j changed by `by`, at its start: scene and run, or nil and why.
function derivative.open(case, j, by)
  local params = {}
  for name, value in pairs(case.params) do params[name] = value end
  for k, p in ipairs(case.parameters) do
    local change = k == j and by or 0
    params[p.name] = p.values and derivative.control_text(p, change) or ("%.17g"):format(p.start + change)
  end
  local scene, refused = hooke.load(case.scene, params, options_of(case))
  if not scene then return nil, refused end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return nil, tostring(run) end
  return scene, run
end

-- Adds the parameters to the record; the pairs of scenes beside, or nil and why not.
function derivative.vary(case, record)
  local pairs_of = {}
  for j, p in ipairs(case.parameters) do
    local by, why = change_of(p, case.factor)
    if not by then return nil, why end
    local more, run_more = derivative.open(case, j, by)
    if not more then return nil, run_more end
    local less, run_less = derivative.open(case, j, -by)
    if not less then return nil, run_less end
    local fine
    if p.values then fine, why = record:vary(run_more, run_less, by, #p.values, p.duration)
    else
      by = ((p.start + by) - (p.start - by)) / 2 -- as the parameters differ after rounding
      fine, why = record:vary(run_more, run_less, by)
    end
    if not fine then return nil, ("%s: %s"):format(p.name, why) end
    pairs_of[j] = { more = more, less = less, by = by }
  end
  return pairs_of
end

-- The run, at that time; or nil and why it does not come there.
function derivative.advance(scene, to)
  local fine, run = pcall(scene.run, scene, { to = to })
  if not fine then return nil, (tostring(run):gsub("^[^\n]-:%d+: (run: to: )", "%1")) end -- the place would be this file
  local summary = run:summary()
  if summary.verdict == "diverged" then return nil, summary.reason or "it diverged" end
  return run
end

-- Of a measure at the end of a run, relative.
local rounding = 64 * 2 ^ -52

-- The derivative by whole runs, at all frames and the end, or where the method chooses its steps by the same steps, at the
-- end: what the steps' own has to agree with, unless there is a kink between. { whole (at the end), slopes (at the frames;
-- nil: by the same steps), noise (the part of rounding in them), steps (the longest of either run, s), ends (the measure where the
-- parameter is larger and smaller), by (by so much) }, or nil and why they do not reach it.
local function by_runs(case, record, j, both, fps)
  local a, b = record:replayed(case.of, j)
  if b == true then return nil, "the same steps fail there" end
  if a then
    return { whole = (a - b) / (2 * both.by), noise = rounding * math.max(math.abs(a), math.abs(b)) / both.by, steps = {},
      ends = { a, b }, by = both.by }
  end
  local found, most, more, less = { slopes = {}, by = both.by }, 0, nil, nil
  for k = 0, math.ceil(case.at * fps - 1e-6) do
    local t = math.min(k / fps, case.at)
    local why, reason
    more, why = derivative.advance(both.more, t)
    less, reason = derivative.advance(both.less, t)
    a, b = more and more:measures()[case.of], less and less:measures()[case.of]
    if not (a and b) then return nil, why or reason or ("the measure is not finite at t = %.9g s"):format(t) end
    most = math.max(most, math.abs(a), math.abs(b))
    found.slopes[k + 1] = (a - b) / (2 * both.by)
  end
  found.whole, found.noise, found.ends = found.slopes[#found.slopes], rounding * most / both.by, { a, b }
  found.steps = { more:summary().dt_max, less:summary().dt_max }
  return found
end

-- Fills the result with the derivatives: rows of the time forwards, the last one alone backwards.
local function differentiate(case, record, result)
  local why = record:refusal(case.of)
  if why then return nil, ("the measure '%s': %s"):format(case.of, why) end
  if case.backwards then
    result.slopes, why = record:adjoint(case.of)
    return result.slopes, why
  end
  result.rows, why = record:tangents(case.of)
  if not result.rows then return nil, why end
  result.slopes = table.move(result.rows[#result.rows], 3, 2 + #case.parameters, 1, {})
  return true
end

-- A run that explodes gains about its largest kinetic energy without a source; beyond a half it is no motion of the scene.
local most_growth = 0.5

-- Why the run's derivative would say nothing, or nil.
function derivative.grown(summary)
  local growth = summary.energy and summary.energy.drift
  if not growth or growth ~= growth or growth <= most_growth then return nil end
  return (("the run explodes: its energy grew by %.3g of the largest kinetic energy without a source, and its derivative says "
    .. "nothing of the scene: take a shorter step (--dt below %.3g)"):format(growth, summary.dt_max))
end

local function execute(case)
  local sensitivity = require("sensitivity")
  local scene, run = derivative.open(case, 0, 0)
  if not scene then return { failed = run, fits = false } end
  local record, why = sensitivity.record(run, case.factor)
  if not record then return { failed = why } end
  local both
  both, why = derivative.vary(case, record)
  if not both then return { failed = why } end
  run, why = derivative.advance(scene, case.at)
  if not run then return { failed = why } end
  local summary = run:summary()
  why = derivative.grown(summary)
  if why then return { failed = why } end
  local fine
  fine, why = record:finish()
  if not fine then return { failed = why } end
  local result = { value = run:measures()[case.of], dt = summary.dt_max, runs = {}, noise = {}, beside = {},
    inaccurate = summary.verdict == "inaccurate" and summary.reason or nil }
  if not result.value then return { failed = ("the measure '%s' is not finite at t = %g s"):format(case.of, case.at) } end
  fine, why = differentiate(case, record, result)
  if not fine then return { failed = why } end
  result.steps, result.particles, result.inexact, result.bytes, result.tol = record:about()
  for j, pair in ipairs(case.compare and both or {}) do
    local whole, unreached = by_runs(case, record, j, pair, summary.fps)
    result.runs[j], result.noise[j] = whole and whole.whole or 0 / 0, whole and whole.noise or 0
    result.beside[j] = whole or { unreached = unreached }
  end
  return result
end

-- ---- for the tool ----

-- case: scene, params, parameters (of common/run/parameters.lua), of, at, integrator, dt, seed, trust, backwards, compare
-- (with whole runs), factor (of the differences by parameters). Returns { value, slopes, rows, runs, dt, steps, ... } or
-- { failed }.
function derivative.take(case)
  case.execute, case.factor = execute, case.factor or 1
  return case_process.run(case)
end

return derivative
