-- The corpus of hard cases (tests/hard/README.md): every case is run with every integrator that fits, judged without
-- its exact solution, and compared with the result that its file requires.
--
-- A cell is a run with the default step, or, below the matrix, a run that the case names in `also`. It ends as
--   ok    verdict ok, within the case's bound
--   wrong verdict ok, beyond the bound: the one failure that cannot be accepted
--   said  any other verdict: the run itself reports that it is not accurate
--   limit ended by the limit of steps, and so never judged
--   unfit the integrator does not take the scene
--   crash, timeout
-- and `failed` is the reason why this end is wrong: `must` names the integrators that have to end as ok, or is "none".
local json = require("cjson").new()
local lfs = require("lfs")
local case_process = require("common.run.case_process")

local hard = {}

hard.step_limit = 15000

-- ---- the metadata of a case ----

local known = { "what", "right", "must", "also", "long", "trust" }

local function number(text)
  local above, below = text:match("^([^/]+)/([^/]+)$")
  if above then return tonumber(above) and tonumber(below) and tonumber(above) / tonumber(below) end
  return tonumber(text)
end

local function names_in(text)
  local list = {}
  for word in text:gmatch("[^%s,]+") do list[#list + 1] = word end
  return list
end

-- "implicit_midpoint dt=1/60" -> a run; or nil and the reason.
local function read_run(text)
  local run = { text = text }
  for word in text:gmatch("%S+") do
    local name, value = word:match("^(%w+)=(.*)$")
    if not run.integrator then run.integrator = word
    elseif (name == "dt" or name == "tol") and number(value) then run[name] = number(value)
    else return nil, ("'%s' is neither dt=SECONDS nor tol=NUMBER"):format(word) end
  end
  return run
end

local function read_also(text)
  local list = {}
  for one in text:gmatch("[^;]+") do
    local run, why = read_run(one:match("^%s*(.-)%s*$"))
    if not run then return nil, why end
    list[#list + 1] = run
  end
  return list
end

-- The metadata of a case from its first block comment; or nil and the error in it.
function hard.read(path)
  local file, why = io.open(path)
  if not file then return nil, why end
  local comment = file:read("a"):match("^%-%-%[%[\n(.-)%]%]")
  file:close()
  if not comment then return nil, path .. ": no block comment with what, right and must at the top" end
  local case, key = { path = path, name = path:match("([^/]+)%.lua$") }, nil
  for line in comment:gmatch("[^\n]+") do
    local found, rest = line:match("^(%w+):%s*(.*)$")
    key = found or key
    local place = hooke.nearest(key or line, known)
    if not key or place ~= key then
      return nil, ("%s: '%s' is none of %s"):format(path, key or line, table.concat(known, ", "))
    end
    case[key] = found and rest or case[key] .. " " .. line:match("^%s*(.*)$")
  end
  for _, needed in ipairs { "what", "right", "must" } do
    if not case[needed] then return nil, ("%s: its comment says nothing for '%s'"):format(path, needed) end
  end
  case.must = case.must == "none" and {} or names_in(case.must)
  case.also, why = read_also(case.also or "")
  if not case.also then return nil, ("%s: also: %s"):format(path, why) end
  case.long = case.long == "true"
  return case
end

-- The cases of a folder, by name; or nil and the reason.
function hard.cases(folder)
  local cases = {}
  if lfs.attributes(folder, "mode") ~= "directory" then
    return nil, folder .. " is not a folder of cases; hooke's sources have some in tests/hard: --hard FOLDER"
  end
  for file in lfs.dir(folder) do
    if file:match("^[^_].*%.lua$") then -- _NAME.lua is a module shared by cases
      local case, why = hard.read(folder .. "/" .. file)
      if not case then return nil, why end
      cases[#cases + 1] = case
    end
  end
  if #cases == 0 then return nil, "no case (NAME.lua) in " .. folder end
  table.sort(cases, function(a, b) return a.name < b.name end)
  return cases
end

-- ---- the runs of the matrix ----

local function has(list, name)
  for _, one in ipairs(list) do
    if one == name then return true end
  end
  return false
end

-- Every name in `must` and `also` has to be an integrator: with a misspelt name the requirement would not be checked.
function hard.check(cases, integrators)
  for _, case in ipairs(cases) do
    local named = { table.unpack(case.must) }
    for _, run in ipairs(case.also) do named[#named + 1] = run.integrator:match("^[^:]+") end
    for _, name in ipairs(named) do
      if not has(integrators, name) then
        local near = hooke.nearest(name, integrators)
        return nil, ("%s: there is no integrator '%s'%s"):format(case.path, name,
          near and (", did you mean '%s'?"):format(near) or "")
      end
    end
  end
  return true
end

local function fixtures() return hooke.plugins .. "/../tests/fixtures" end

-- The plugins for tests that a case needs and that are not built, which make alone does not do; nil: none is missing.
function hard.missing(case)
  if not case.trust then return nil end
  local file = io.open(case.path)
  local text = file and file:read("a") or ""
  if file then file:close() end
  for name in text:gmatch('fixtures %.%. "/([%w_]+%.so)"') do
    if not lfs.attributes(("%s/%s"):format(fixtures(), name), "mode") then return name end
  end
end

local function cell_of(case, run, options)
  return { case = case, run = run, must = not run.text and has(case.must, run.integrator), process_case = {
    scene = case.path, integrator = run.integrator, dt = run.dt, tol = run.tol, ignore_exact = true, trust = case.trust ~= nil,
    params = case.trust and { fixtures = fixtures() } or nil,
    step_limit = not options.long and hard.step_limit or nil, timeout = options.timeout } }
end

-- The cells of all cases for the chosen integrators (some of which only `also` may name).
function hard.cells(cases, integrators, options)
  local cells = {}
  for _, case in ipairs(cases) do
    for _, name in ipairs(integrators) do cells[#cells + 1] = cell_of(case, { integrator = name }, options) end
    for _, run in ipairs(case.also) do
      if has(integrators, run.integrator:match("^[^:]+")) then cells[#cells + 1] = cell_of(case, run, options) end
    end
  end
  return cells
end

-- ---- running and judging the cells ----

local function ending(r)
  if r.verdict == "timeout" then return "timeout" end
  if r.verdict == "crashed" then return "crash" end
  if r.fits == false then return "unfit" end
  if r.verdict == "interrupted" then return "limit" end
  if r.verdict ~= "ok" then return "said" end
  if r.second_failed then return "limit" end -- the check at half the step needs more steps
  return r.exact_error and r.accuracy and r.exact_error <= r.accuracy and "ok" or "wrong"
end

local function failure(cell)
  local r, ended = cell.result, cell.ended
  if ended == "wrong" and not r.accuracy then return "the case says no accuracy" end
  if ended == "wrong" and not r.exact_error then return "the case has no exact solution for its end" end
  if ended == "wrong" then return "said ok beyond the bound" end
  if ended == "crash" or ended == "timeout" then return r.failed end
  if cell.must and ended ~= "ok" then return "it has to reach the bound" end
  return nil
end

local function take(cell, result)
  cell.result = result
  cell.ended = ending(result)
  cell.failed = failure(cell)
end

-- Runs the cells, `jobs` at a time; done(cell) as each ends.
function hard.run(cells, jobs, done, tick)
  local of, k = {}, 0
  for _, cell in ipairs(cells) do of[cell.process_case] = cell end
  case_process.each(jobs, function()
    k = k + 1
    return cells[k] and cells[k].process_case
  end, function(case, result)
    take(of[case], result)
    if done then done(of[case]) end
  end, tick)
end

-- ---- printing ----

local mark = { ok = "ok", wrong = "!!", said = "x", limit = "..", unfit = "-", timeout = "T", crash = "#" }

local function mark_of(cell)
  if not cell then return "" end
  return cell.failed and cell.ended ~= "wrong" and mark[cell.ended] .. "!" or mark[cell.ended]
end

-- The names of the columns, each one line below the name before it.
local function header(integrators, width)
  local lines = {}
  for k, name in ipairs(integrators) do
    lines[k] = (" "):rep(width) .. (" | "):rep(k - 1) .. " " .. name
  end
  return table.concat(lines, "\n")
end

local function by_place(cells)
  local at = {}
  for _, cell in ipairs(cells) do
    at[cell.case] = at[cell.case] or {}
    if not cell.run.text then at[cell.case][cell.run.integrator] = cell end
  end
  return at
end

function hard.matrix(cases, integrators, cells)
  local width, at = 0, by_place(cells)
  for _, case in ipairs(cases) do width = math.max(width, #case.name) end
  local lines = { header(integrators, width) }
  for _, case in ipairs(cases) do
    local row = { case.name .. (" "):rep(width - #case.name) }
    for _, name in ipairs(integrators) do row[#row + 1] = (" %-2s"):format(mark_of((at[case] or {})[name])) end
    lines[#lines + 1] = (table.concat(row):gsub("%s+$", ""))
  end
  return table.concat(lines, "\n")
end

hard.legend = "ok within the bound   x said so itself   .. more than the limit of steps   - does not fit\n"
  .. "!! ok beyond the bound   x! .. ! -! had to reach the bound   T! too slow   #! crashed"

local function figure(x) return x and ("%.3g"):format(x) or "-" end

local function setting(cell)
  return ("%-20s %s"):format(cell.case.name, cell.run.text or cell.run.integrator)
end

local function reason(r)
  local text = r.reason ~= "" and r.reason or r.failed or r.second_failed or ""
  return (text:gsub("%s+", " "))
end

function hard.describe(cell)
  local r = cell.result
  return ("%-48s %-7s error %-9s bound %-8s %s"):format(setting(cell), cell.ended, figure(r.exact_error),
    figure(r.accuracy), cell.failed and cell.failed .. (reason(r) ~= "" and ": " .. reason(r) or "") or reason(r))
end

function hard.counts(cells)
  local count = { failed = 0 }
  for name in pairs(mark) do count[name] = 0 end
  for _, cell in ipairs(cells) do
    count[cell.ended] = count[cell.ended] + 1
    if cell.failed then count.failed = count.failed + 1 end
  end
  return count
end

function hard.slowest(cells, most)
  local list = { table.unpack(cells) }
  table.sort(list, function(a, b) return a.result.process_s > b.result.process_s end)
  return { table.unpack(list, 1, math.min(most, #list)) }
end

-- ---- rows for CSV and JSON ----

hard.columns = { "case", "integrator", "setting", "must", "ended", "failed", "verdict", "error", "bound",
  "verify_difference", "energy_drift", "steps", "force_evaluations", "dt_max", "dt_limit", "process_s", "reason" }

function hard.row(cell)
  local r = cell.result
  return { case = cell.case.name, integrator = cell.run.integrator, setting = cell.run.text or "default",
    must = cell.must or false, ended = cell.ended, failed = cell.failed, verdict = r.verdict, error = r.exact_error,
    bound = r.accuracy, verify_difference = r.verify_difference, energy_drift = r.energy and r.energy.drift,
    steps = r.steps, force_evaluations = r.force_evaluations, dt_max = r.dt_max, dt_limit = r.dt_limit,
    process_s = r.process_s, reason = reason(r) }
end

function hard.json(cells)
  local rows = {}
  for k, cell in ipairs(cells) do rows[k] = hard.row(cell) end
  json.encode_invalid_numbers("null")
  return json.encode { cells = rows, counts = hard.counts(cells) }
end

return hard
