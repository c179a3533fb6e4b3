-- One run of a scene, in a process of its own, so that a run that diverges, crashes or never ends does not affect the
-- others.
--
-- A case is a table:
--   scene                     the script's path
--   params                    { name = value } of the scene
--   integrator, solver        "name" or "name:parameter=value,..."; nil: the scene's choice
--   dt, tol, ["until"], accuracy, seed, threads (1), without (labels), step_limit, perturb, perturb_seed, ignore_exact
--                             as in hooke run and core/run/run/run.h
--   verify                    true: checked by a second run (hooke run --verify; always, where the scene asks for accuracy)
--   timeout                   s, of wall time; the process is then ended
--   allowance                 s, of processor time, a bound that does not depend on what else the machine does; the process
--                             is then ended
--   frames                    true: `finish` gets the states of all frames, packed (tools/native/states.c)
--   finish                    function(result, states, run) called in the process after the run: adds to the result
--   keep                      true: result.states comes back, too
--   execute                   function(case) that gives the result instead: for scripts that drive their own runs. Of
--                             the rest only scene, trust and timeout then mean anything
--   told                      function(message): `execute` has a second argument, tell(message), which hands it plain tables
--                             while the process goes on
-- A result is the run's summary (scripts/README.md, run:summary), with parameter_units { name = unit }, or, without one,
-- `failed`, the cause as a text, and `fits` = false when the scene or its options were refused before the first step.
local process = require("process")
local units = require("common.run.units")

local case_process = {}

local passed_on = { "integrator", "solver", "dt", "tol", "until", "accuracy", "seed", "without", "step_limit", "perturb",
  "perturb_seed", "ignore_exact", "trust", "accuracy_at", "fps", "duration" }

local function options_of(case)
  local options = { threads = case.threads or 1 }
  for _, key in ipairs(passed_on) do options[key] = case[key] end
  return options
end

local function advance(scene, case, states)
  local run = scene:run { to = 0 }
  local summary = run:summary()
  if not case.frames then return scene:run() end
  states[1] = run:packed()
  for k = 1, math.huge do
    local t = k / summary.fps
    if t >= summary["end"] * (1 - 1e-12) then break end
    scene:run { to = t }
    states[#states + 1] = run:packed()
  end
  scene:run()
  states[#states + 1] = run:packed()
  return run
end

-- The cause without the line of this tool that asked for the run; the lines of the scene's own script stay.
local function without_tool(message)
  local text = tostring(message)
  local tool = hooke.folder .. "/"
  return text:sub(1, #tool) == tool and text:gsub("^.-%.lua:%d+: ", "", 1) or text
end

-- Runs the case in the process of the caller, which a crash would end. The second result is the list of states.
function case_process.execute(case)
  local scene, more = hooke.load(case.scene, case.params, options_of(case))
  if not scene then return { failed = more, fits = false } end
  local states = {}
  local begun, first = pcall(scene.run, scene, { to = 0 })
  if not begun then return { failed = without_tool(first), fits = false } end
  local fine, message = pcall(advance, scene, case, states)
  local result = first:summary()
  if fine and (result.accuracies > 0 or case.verify) then
    local again
    result, again = first:verify()
    result.second_failed = again
  end
  result.parameter_units = units.of_parameters(more)
  if not fine then result.failed = without_tool(message) end
  if not fine and result.steps == 0 and result.verdict ~= "diverged" then result.fits = false end
  if case.finish then case.finish(result, states, first) end
  return result, states
end

-- A list of floats and nothing else as their bytes; nil: it is none, or short. A text of each number takes 30 times as long, and an
-- optimisation tells all of its states at each iteration.
local group = 200 -- of arguments of a call
local function packed(list)
  local n, others = #list, next(list, #list > 0 and #list or nil)
  if n < 4 or others ~= nil then return nil end
  for k = 1, n do
    if math.type(list[k]) ~= "float" then return nil end
  end
  local parts = {}
  for k = 1, n, group do
    local last = math.min(k + group - 1, n)
    parts[#parts + 1] = string.pack("<" .. ("d"):rep(last - k + 1), table.unpack(list, k, last))
  end
  return table.concat(parts)
end

local function unpacked(bytes)
  local list, n = {}, #bytes // 8
  for k = 1, n, group do
    local count = math.min(group, n - k + 1)
    table.move({ string.unpack("<" .. ("d"):rep(count), bytes, 8 * k - 7) }, 1, count, k, list)
  end
  return list
end

-- Rows of equally many floats, as the states at knots, as their bytes and the length of a row; nil: it is something else.
local function packed_rows(list)
  local flat, width = {}, type(list[1]) == "table" and #list[1] or 0
  if width == 0 or next(list, #list) ~= nil then return nil end
  for k, row in ipairs(list) do
    if type(row) ~= "table" or #row ~= width or next(row, width) ~= nil then return nil end
    table.move(row, 1, width, (k - 1) * width + 1, flat)
  end
  return packed(flat), width
end

local function unpacked_rows(width, bytes)
  local flat, rows = unpacked(bytes), {}
  for k = 1, #flat // width do rows[k] = table.move(flat, (k - 1) * width + 1, k * width, 1, {}) end
  return rows
end

-- A value as text of a Lua expression, with all bits of numbers.
local function dump(value)
  if type(value) ~= "table" then return ("%q"):format(value) end
  local bytes = packed(value)
  if bytes then return ("F%q"):format(bytes) end
  local rows, width = packed_rows(value)
  if rows then return ("M(%d,%q)"):format(width, rows) end
  local parts = {}
  for key, item in pairs(value) do parts[#parts + 1] = ("[%s]=%s"):format(dump(key), dump(item)) end
  return "{" .. table.concat(parts, ",") .. "}"
end

local function undump(text) return assert(load("return " .. text, "=result", "t", { F = unpacked, M = unpacked_rows }))() end

-- What hooke.explain(path, params, options) returns, from a process of its own that the scene cannot leave.
function case_process.explain(path, params, options)
  local pid, fd = process.fork()
  if pid == 0 then
    if not (options and options.trust) then hooke.confine(path) end
    local fine, explained, why = pcall(hooke.explain, path, params, options)
    process.write(fd, dump { explained = fine and explained or nil, why = fine and why or tostring(explained) })
    process.exit(0)
  end
  local parts = {}
  repeat parts[#parts + 1] = process.read(fd) until parts[#parts] == ""
  process.close(fd)
  local how, code = process.wait(pid)
  local text = table.concat(parts)
  if text == "" then return nil, ("explaining %s crashed (%s %d)"):format(path, how, code) end
  local result = undump(text)
  return result.explained, result.why
end

-- Loads the installation's plugins that a case names before the fork, so that the processes of cases need not load
-- them. The scene's script tells them in a process of its own, or has told them before: case.explained.
local loaded = {}
function case_process.warm(case)
  local key = case.scene .. "\0" .. (case.integrator or "") .. "\0" .. (case.solver or "")
  if loaded[key] then return end
  loaded[key] = true
  local explained = case.explained or case_process.explain(case.scene, case.params, { trust = case.trust })
  if not explained then return end
  local list = table.move(explained.plugins, 1, #explained.plugins, 1, {})
  for kind, choice in pairs { integrator = case.integrator or explained.integrator, solver = case.solver or explained.solver } do
    list[#list + 1] = { kind = kind, name = choice:gsub(":.*", "") }
  end
  for _, plugin in ipairs(list) do
    if plugin.name:match("^[%w_]+$") and plugin.kind:match("^%a+$") then
      pcall(hooke.describe, ("%s/%ss/%s.so"):format(hooke.plugins, plugin.kind, plugin.name))
    end
  end
end

-- ---- processes ----

local function child(case, fd)
  if not case.trust then hooke.confine(case.scene) end
  local function tell(message) process.write(fd, string.pack("<s8", dump { told = message })) end
  local fine, result, states = pcall(case.execute or case_process.execute, case, tell)
  if not fine then result = { failed = tostring(result) } end
  local parts = { string.pack("<s8", dump(result)) }
  for _, state in ipairs(case.keep and states or {}) do parts[#parts + 1] = string.pack("<s8", state) end
  process.write(fd, table.concat(parts))
  process.exit(0)
end

local function start(case)
  if not case.execute then case_process.warm(case) end
  local pid, fd = process.fork()
  if pid == 0 then child(case, fd) end
  return { case = case, pid = pid, fd = fd, parts = {}, begun = process.clock() }
end

local function unpack_result(text, keep)
  local fine, encoded, at = pcall(string.unpack, "<s8", text)
  if not fine then return nil end
  local result = undump(encoded)
  if keep then result.states = {} end
  while keep and at <= #text do
    result.states[#result.states + 1], at = string.unpack("<s8", text, at)
  end
  return result
end

-- Hands over the messages that have come whole; what follows them stays.
local function hear(job)
  local text, at = table.concat(job.parts), 1
  while #text - at >= 7 do
    local behind = at + 8 + string.unpack("<I8", text, at)
    local message = behind <= #text + 1 and undump(text:sub(at + 8, behind - 1))
    if not message or message.told == nil then break end
    job.case.told(message.told)
    at = behind
  end
  job.parts = { text:sub(at) }
end

-- An allowance bounds the wall time too, for a process that waits for something.
local most_idle = 30 -- wall s in a second of processor time, and beside

local function is_late(job)
  local case, wall = job.case, process.clock() - job.begun
  if wall > (case.timeout or math.huge) then return true end
  if not case.allowance then return false end
  local used = process.processor_time(job.pid)
  return (used or wall) > case.allowance or wall > most_idle * (1 + case.allowance)
end

local function finish(job)
  process.close(job.fd)
  local before = process.processor_time()
  local how, code = process.wait(job.pid)
  local used = process.processor_time() - before
  local result = unpack_result(table.concat(job.parts), job.case.keep)
  if job.late then
    result = { failed = ("ended after %.3g s"):format(job.case.allowance or job.case.timeout), verdict = "timeout" }
  elseif not result then
    result = { failed = ("the process crashed (%s %d)"):format(how == "signal" and how or "exit code", code),
      verdict = "crashed" }
  end
  result.process_s, result.processor_s = process.clock() - job.begun, used
  return result
end

-- ---- an interruption ----

case_process.interrupted = setmetatable({}, { __tostring = function() return "interrupted" end })
local stopping -- a descriptor that can be read once the user wants the end; nil: signals end this process as they do

-- From now on `each` and `run` end with the error case_process.interrupted, their processes ended, once fd can be read.
function case_process.stop_at(fd) stopping = fd end

local function stop(jobs)
  for _, job in pairs(jobs) do
    process.kill(job.pid)
    process.close(job.fd)
    process.wait(job.pid)
  end
  error(case_process.interrupted, 0)
end

-- Short allowances are looked at more often.
local function watch(jobs)
  local fds, ended, interval = { stopping }, {}, 0.1
  for fd, job in pairs(jobs) do
    fds[#fds + 1] = fd
    interval = math.max(0.01, math.min(interval, (job.case.allowance or math.huge) / 8))
  end
  local ready = process.ready(fds, interval)
  if stopping and ready[stopping] then stop(jobs) end
  for fd, job in pairs(jobs) do
    local text = ready[fd] and process.read(fd)
    if text and text ~= "" then
      job.parts[#job.parts + 1] = text
      if job.case.told then hear(job) end
    elseif text then
      ended[#ended + 1] = job
    elseif is_late(job) then
      process.kill(job.pid)
      job.late = true
      ended[#ended + 1] = job
    end
  end
  -- Ctrl-C ends the runs as well, which may be seen first.
  if stopping and #ended > 0 and process.ready({ stopping }, 0)[stopping] then stop(jobs) end
  return ended
end

-- Runs cases, `jobs` at a time: next() returns a case or nil, done(case, result) is called for each case at its end (in
-- any order), and tick() some times per second.
function case_process.each(jobs, next, done, tick)
  local running, count, more = {}, 0, true
  while more or count > 0 do
    while more and count < jobs do
      local case = next()
      if not case then more = false break end
      local job = start(case)
      running[job.fd] = job
      count = count + 1
    end
    for _, job in ipairs(count > 0 and watch(running) or {}) do
      running[job.fd] = nil
      count = count - 1
      done(job.case, finish(job))
    end
    if tick then tick() end
  end
end

-- Runs one case.
function case_process.run(case)
  local result
  local rest = { case }
  case_process.each(1, function() return table.remove(rest) end, function(_, r) result = r end)
  return result
end

return case_process
