-- hooke sweep SCENE.lua name=1,2,5 ...: many runs over values of parameters, in parallel, with a table and plots.
-- Or of a SWEEP.lua, which names them. Every case runs in a process of its own, and its result is stored in a database
-- at once.
local child = require("common.sweep.child")
local command = require("common.sweep.command")
local command_line = require("common.run.command_line")
local database = require("common.sweep.database")
local digest = require("common.sweep.digest")
local figures = require("common.sweep.plot")
local plan = require("common.sweep.plan")
local process = require("process")
local progress = require("common.run.progress")
local remarks = require("common.sweep.remarks")
local rows = require("common.sweep.table")
local slurm = require("common.sweep.slurm")
local spread = require("common.sweep.spread")
local store = require("common.sweep.store")
local case_process = require("common.run.case_process")

-- ---- checks before the first case ----

-- The measures of the scenes, from a start of each; nil when a scene does not start.
local function measures_of(the)
  local names, seen = {}, {}
  for _, case in ipairs(the.cases) do
    if not seen[case.scene] then
      seen[case.scene] = true
      local result = case_process.run { scene = case.scene, params = case.params, integrator = case.integrator,
        solver = case.solver, trust = case.trust, ["until"] = 0, timeout = 60 }
      if not result.measures then return nil end
      for name in pairs(result.measures) do names[#names + 1] = name end
    end
  end
  return names
end

local function check_measures(the)
  local asked = { table.unpack(the.definition.measures or {}) }
  for _, figure in ipairs(the.figures) do
    for _, name in ipairs(figures.measures(figure)) do asked[#asked + 1] = name end
  end
  if #asked == 0 then return end
  local names, known = measures_of(the), {}
  if not names then return end
  for _, column in ipairs(store.reported) do names[#names + 1] = column[1] end
  for _, axis in ipairs(the.axes) do names[#names + 1] = axis.name end
  for _, name in ipairs(names) do known[name] = true end
  for _, name in ipairs(asked) do
    if not known[name] then plan.unknown("measure", name, names) end
  end
end

-- ---- running ----

local function paths_in(states, particles)
  local points = {}
  for frame, state in ipairs(states) do
    local n, t = string.unpack("<dd", state)
    n = math.tointeger(n)
    local index = {}
    for k = 1, n do index[math.tointeger((string.unpack("<d", state, 9 + 8 * k)))] = k end
    for _, id in ipairs(particles) do
      if index[id] then
        local x, y, z = string.unpack("<ddd", state, 17 + 8 * n + 24 * (index[id] - 1))
        points[#points + 1] = { id, frame - 1, t, x, y, z }
      end
    end
  end
  return points
end

-- Converts the floats of a result to texts of 17 digits and back, since JSON, by which the process sends it, keeps
-- fewer.
local function digits_of(result)
  local digits = {}
  for key, value in pairs(result) do
    if type(value) == "table" then digits[key] = digits_of(value)
    elseif math.type(value) == "float" then digits[key] = ("%.17g"):format(value) end
  end
  return digits
end

local function restore(result, digits)
  for key, value in pairs(digits) do
    if type(value) == "table" then restore(result[key], value)
    elseif type(value) == "string" then result[key] = tonumber(value) end -- in a list the other entries are null
  end
end

local stopped_well = { ok = true, inaccurate = true }

local function process_case_of(case, particles)
  local t = { case = case }
  for _, key in ipairs { "scene", "params", "integrator", "solver", "dt", "tol", "until", "accuracy", "verify", "seed",
    "step_limit", "timeout", "threads", "trust" } do
    t[key] = case[key]
  end
  t.frames = particles ~= nil
  t.finish = function(result, states, run)
    result.plugins = nil
    if stopped_well[result.verdict] then result.state = digest.of(run:packed()) end
    if particles then result.paths = paths_in(states, particles) end
    result.digits = digits_of(result)
  end
  return t
end

-- Runs the cases that are not done.
local function run(the, cases, results)
  local waiting, next_one = {}, 0
  for _, case in ipairs(cases) do
    if not case.row then waiting[#waiting + 1] = case end
  end
  results:link_all(cases)
  local bar = progress.new { what = the.definition.name, total = #cases, done = #cases - #waiting, quiet = the.quiet }
  local function next_case()
    next_one = next_one + 1
    return waiting[next_one] and process_case_of(waiting[next_one], the.definition.paths)
  end
  local function done(t, result)
    collectgarbage("step", 20)
    restore(result, result.digits or {})
    results:add(t.case, result)
    local verdict = store.verdict(result, t.case)
    bar:add { failed = verdict ~= "ok" and verdict ~= "inaccurate" }
  end
  collectgarbage() -- a collection in a case's process would copy every page that it shares with this one
  collectgarbage("stop")
  case_process.each(the.definition.jobs or process.processors(), next_case, done, function() bar:tick() end)
  collectgarbage("restart")
  bar:finish()
end

-- "1-3,7" -> { [1] = true, ... }
local function numbers_in(text, most)
  local set = {}
  for piece in (text .. ","):gmatch("([^,]*),") do
    local from, to = piece:match("^(%d+)%-(%d+)$")
    from, to = tonumber(from or piece:match("^%d+$")), tonumber(to or piece:match("^%d+$"))
    if not from or not to then plan.refuse("--case: '%s' is not 7 or 1-20 or 3,5,9-12", text) end
    if from < 1 or to > most then plan.refuse("--case: %s: the cases are numbered from 1 to %d", piece, most) end
    for k = from, to do set[k] = true end
  end
  return set
end

local function chosen(the, text)
  if not text then return the.cases end
  local set, list = numbers_in(text, #the.cases), {}
  for _, case in ipairs(the.cases) do
    if set[case.number] then list[#list + 1] = case end
  end
  return list
end

local function text_of(value)
  return math.type(value) == "float" and ("%.17g"):format(value) or tostring(value)
end

local function print_cases(the)
  for _, case in ipairs(the.cases) do
    local parts = { tostring(case.number) }
    for _, axis in ipairs(the.axes) do
      parts[#parts + 1] = ("%s=%s"):format(axis.name, text_of(case.values[axis.name]))
    end
    print(table.concat(parts, "\t"))
  end
end

-- The axes with their values and the common settings of all cases, one line each: this text identifies a sweep.
local function definition_text(the)
  local lines = {}
  for k, axis in ipairs(the.axes) do
    local values = {}
    for j, value in ipairs(axis.values) do
      values[j] = axis.kind == "integrator" and value.label or axis.kind == "scene" and value:match("[^/]*$")
        or text_of(value)
    end
    lines[k] = ("%s = %s"):format(axis.name, table.concat(values, ", "))
  end
  for _, name in ipairs { "until", "accuracy", "verify", "seed", "step_limit" } do
    if the.definition[name] ~= nil then lines[#lines + 1] = ("%s = %s"):format(name, text_of(the.definition[name])) end
  end
  return table.concat(lines, "\n")
end

local function refuse_half_done(the, count, path)
  if count == 0 or count == #the.cases then return end
  plan.refuse("%d of %d cases are in %s already: --resume goes on, --again does everything again, --db FILE writes " ..
    "elsewhere", count, #the.cases, path)
end

-- ---- reports and files ----

local function report(the, results, given)
  results:find(the.cases)
  results:read(the.cases)
  local code = 0
  local spreads = spread.list(the, given["--linear"])
  if not the.quiet then rows.show(the) end
  if not the.quiet then spread.show(spreads) end
  if #spreads > 0 then
    local fine, why = spread.write(spreads, the.base .. "-spread.csv", given["--linear"])
    if not fine then database.fail("sweep: %s", why) end
  end
  if given["--csv"] then
    local fine, why = rows.write_csv(the, given["--csv"])
    if not fine then database.fail("sweep: %s", why) end
  end
  for _, figure in ipairs(the.figures) do
    local path, why = figures.draw(the, results, figure, the.base)
    if path and not the.quiet then print(("%s.png, .svg"):format(path)) end
    if not path then
      command_line.complain("sweep", why)
      code = 4
    end
  end
  local counts, notes = rows.count(the)
  for _, lines in ipairs { remarks.warnings(the), remarks.equal_lines(the) } do table.move(lines, 1, #lines, #notes + 1, notes) end
  for _, note in ipairs(notes) do command_line.complain("sweep", note) end
  if not the.quiet then print(("%s: %s; %s"):format(the.definition.name, counts, results.path)) end
  return code
end

local function prepare(asked)
  local definition = command.define(asked)
  local the = plan.make(definition)
  the.plugins = child.plugins()
  the.quiet = asked.given["--quiet"]
  the.figures = figures.list(definition.plots, asked.given["--plot"], the)
  plan.check_plugins(the, the.plugins)
  return the
end

local function execute(asked)
  local given = asked.given
  local the = prepare(asked)
  if given["--print-cases"] then return print_cases(the) end
  check_measures(the)
  store.identify(the.cases, the.plugins, the.definition.paths)
  local path = given["--part"] or given["--db"] or ("out/sweep/%s.db"):format(the.definition.name)
  the.base = path:gsub("%.db$", "")
  if given["--report"] and not (given["--merge"] or store.exists(path) or slurm.has_parts(path)) then
    plan.refuse("--report: there is no %s: run the sweep first, or name its database with --db", path)
  end
  local results = store.open(path, given["--part"] and "delete")
  results:begin(the.definition.name, definition_text(the))
  for _, part in ipairs(given["--merge"] or {}) do results:merge(part) end
  if given["--again"] then slurm.forget(results) end
  slurm.collect(results)
  local cases = chosen(the, given["--case"])
  local count = results:find(cases)
  if given["--merge"] or given["--report"] then
    results:link_all(cases)
    return report(the, results, given)
  end
  if given["--again"] then results:forget(cases)
  elseif given["--retry"] then results:forget(results:broken(cases))
  elseif not given["--resume"] and not given["--case"] then refuse_half_done(the, count, path) end
  if given["--slurm"] then
    local ended = slurm.submit(the, results, cases, asked)
    return ended and report(the, results, given) or 0
  end
  run(the, cases, results)
  return given["--case"] and 0 or report(the, results, given)
end

local function main()
  local asked = command.parse(arg)
  if asked.given["--help"] then return command.help() end
  if not asked.path then plan.refuse("no sweep given: hooke sweep SWEEP.lua | SCENE.lua name=values; see: hooke sweep --help") end
  return execute(asked) or 0
end

local fine, code = pcall(main)
if fine then return code end
io.stderr:write("hooke: " .. hooke.plain(tostring(code)) .. "\n")
return type(code) == "table" and code.code or 1
