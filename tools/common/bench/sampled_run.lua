-- A run that records every frame: the motion (packed states) and the scene's measures, compared with those of another
-- run. It replaces case_process.execute; a case (tools/common/run/case_process.lua) then also has
--   every          record every k-th frame (1), and the last one
--   motion         true: the result has `motion`, what compare() takes, and with keep = true the states come along
--   against        a reference motion: the result has `error`, the differences from it
--   repeats, repeat_s   largest number of further runs, without recording, one at least and then while they together
--                  take less than repeat_s seconds, as far as the case's allowance goes: result.times lists their step_s;
--                  of the recorded run alone, which stops at every frame, where there is no time for others
-- The result's step_s is the wall time of the time loop, s, or the processor time of the whole run where that is less:
-- the machine then did something else in the meantime.
--
-- Errors: at a frame, the root mean square (and the largest) over all particles of the distance between the positions,
-- and between the velocities; of these the root mean square (the largest) over the frames after the start. For a
-- measure: the root mean square over the frames of the difference. Where the scene gives its exact solution, the error
-- of the positions is against that; the exact solution gives neither the largest error nor velocities of several
-- particles.
local states = require("states")

local sampled_run = {}

local function rms(list)
  local sum = 0
  for _, value in ipairs(list) do sum = sum + value * value end
  return #list > 0 and math.sqrt(sum / #list) or 0
end

local function most(list)
  local largest = 0
  for _, value in ipairs(list) do
    if value > largest or value ~= value then largest = value end
  end
  return largest
end

-- Differences over the frames after the start. `last`: up to this frame only. Also returns the x of every frame.
function sampled_run.compare(a, b, last)
  local x, x_max, v, v_max, measure = {}, {}, {}, {}, {}
  local count = math.min(#a.states, #b.states, last or math.huge)
  if not last and #a.states ~= #b.states then return nil, "one of the runs did not reach the end" end
  for k = 2, count do
    local d, why = states.distance(a.states[k], b.states[k])
    if not d then return nil, why end
    x[k - 1], x_max[k - 1], v[k - 1], v_max[k - 1] = d.x_rms, d.x_max, d.v_rms, d.v_max
  end
  for name, list in pairs(a.measures) do
    local other, difference = b.measures[name] or {}, {}
    for k = 2, count do difference[k - 1] = math.abs((list[k] or 0 / 0) - (other[k] or 0 / 0)) end
    measure[name] = rms(difference)
  end
  return { x_rms = rms(x), x_max = most(x_max), v_rms = rms(v), v_max = most(v_max), measure = measure, x = x, v = v }
end

-- ---- one run ----

local function look(run, motion)
  local summary = run:summary()
  motion.states[#motion.states + 1] = run:packed()
  motion.t[#motion.t + 1] = summary.t
  motion.exact[#motion.exact + 1] = summary.exact_error
  for name, value in pairs(summary.measures) do
    motion.measures[name] = motion.measures[name] or {}
    motion.measures[name][#motion.t] = value
  end
end

local function advance(scene, case, motion)
  local run = scene:run { to = 0 }
  local summary = run:summary()
  look(run, motion)
  for k = case.every or 1, math.huge, case.every or 1 do
    local t = k / summary.fps
    if t >= summary["end"] * (1 - 1e-12) then break end
    scene:run { to = t }
    look(run, motion)
  end
  scene:run()
  look(run, motion)
  return run
end

local function errors(case, motion)
  local error, why = sampled_run.compare(motion, case.against, nil)
  if not error then return { failed = why } end
  error.x, error.v = nil, nil
  if #motion.exact == #motion.t then
    local after = table.move(motion.exact, 2, #motion.exact, 1, {})
    error.x_rms = rms(after)
    if #motion.states[1] == (2 + 7) * 8 then error.x_max = most(after) end -- the exact solution is of one particle
    error.exact = true
  end
  return error
end

-- The processor time that `work` takes, and what it returns.
local function timed(work, ...)
  local begun = os.clock()
  local result = table.pack(work(...))
  return os.clock() - begun, table.unpack(result, 1, result.n)
end

-- Of a piece of work, from its processor time and its wall time: the processor's clock, which leaves out what else the machine
-- does, is wrong by some ms on some virtual machines, so that of shorter pieces the wall time counts, the least of many.
local function least_time(processor, wall)
  local sure = 0.02
  return wall < sure and wall or math.min(processor, wall)
end

local function again(case)
  local options = { threads = case.threads or 1 }
  for _, key in ipairs { "integrator", "solver", "dt", "tol", "until", "seed", "trust" } do options[key] = case[key] end
  local scene = hooke.load(case.scene, case.params, options)
  local run = scene:run { to = 0 }
  local processor = timed(scene.run, scene)
  return least_time(processor, run:summary().step_wall_s)
end

local function time(case, first)
  local times, total = {}, 0
  local function affordable() return os.clock() + 1.5 * (times[1] or first) < (case.allowance or math.huge) end
  while #times < case.repeats and (#times == 0 or total < (case.repeat_s or math.huge)) and affordable() do
    local processor, seconds = timed(again, case)
    times[#times + 1] = seconds
    total = total + processor
  end
  return #times > 0 and times or { first }
end

-- The engine's message without the line of this file that Lua puts before it.
local function bare(message) return (tostring(message):gsub("^[^\n]-sampled_run%.lua:%d+: ", "")) end

function sampled_run.execute(case)
  local options = { threads = case.threads or 1, ignore_exact = true }
  for _, key in ipairs { "integrator", "solver", "dt", "tol", "until", "seed", "trust", "perturb", "perturb_seed" } do
    options[key] = case[key]
  end
  local scene, refused = hooke.load(case.scene, case.params, options)
  if not scene then return { failed = refused, fits = false } end
  local begun, first = pcall(scene.run, scene, { to = 0 })
  if not begun then return { failed = bare(first), fits = false } end
  local motion = { states = {}, t = {}, exact = {}, measures = {} }
  local processor, fine, message = timed(pcall, advance, scene, case, motion)
  local result = first:summary()
  result.step_s = least_time(processor, result.step_wall_s)
  if not fine then
    result.failed = bare(message)
    if result.steps == 0 and result.verdict ~= "diverged" then result.fits = false end
    return result
  end
  if case.against then result.error = errors(case, motion) end
  if case.motion then result.motion = { t = motion.t, exact = motion.exact, measures = motion.measures } end
  if case.repeats and result.verdict == "ok" then result.times = time(case, result.step_s) end
  return result, motion.states
end

return sampled_run
