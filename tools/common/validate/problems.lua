-- Finding the problems of `hooke validate` and asking them: every question runs in a process of its own, in the sandbox
-- of scenes, with a limit of time. A problem is a file FOLDER/TOPIC/NAME.lua (scripts/validation/README.md).
local case_process = require("common.run.case_process")
local lfs = require("lfs")
local process = require("process")

local tool_runs = require("common.validate.tool_runs")

local problems = {}

local function folders_in(folder)
  local names = {}
  for name in lfs.dir(folder) do
    if not name:match("^%.") and lfs.attributes(folder .. "/" .. name, "mode") == "directory" then
      names[#names + 1] = name
    end
  end
  table.sort(names)
  return names
end

local function files_in(folder)
  local names = {}
  for name in lfs.dir(folder) do
    local plain = name:match("^([^_.].*)%.lua$") -- _name.lua is a part that problems share
    if plain then names[#names + 1] = plain end
  end
  table.sort(names)
  return names
end

function problems.topics(root) return folders_in(root) end

-- All problems below `root`: { topic =, name =, path = }.
function problems.all(root)
  local list = {}
  for _, topic in ipairs(folders_in(root)) do
    for _, name in ipairs(files_in(root .. "/" .. topic)) do
      list[#list + 1] = { topic = topic, name = name, path = ("%s/%s/%s.lua"):format(root, topic, name) }
    end
  end
  return list
end

-- The problem of a user's file.
function problems.at(path)
  local folder, name = path:match("^(.*)/([^/]+)%.lua$")
  local topic = (folder or ""):match("([^/]*)$"):gsub("[^%w_%-]", "_") -- files of the page are called like it
  return { topic = topic:find("%w") and topic or "yours", name = name or path:gsub("%.lua$", ""), path = path }
end

-- The message with the file and the line: that of the field that it names in quotes or begins with, or that of problem{}.
local function located(message, path)
  local name = path:match("[^/]*$")
  if message:find("has to return a table with the function", 1, true) then
    return name .. ": a problem ends with return validation.problem { ... }, see scripts/validation/README.md"
  end
  if message:find(name .. ":", 1, true) then return message end
  local file, line = io.open(path), 0
  local best, word = nil, message:match("'([^']+)'") or message:match("^[%w_]+")
  word = word and word:gsub("%p", "%%%0")
  for text in file and file:lines() or function() end do
    line = line + 1
    local code = text:gsub("%-%-.*", "")
    if word and code:find(word .. "[%s\"']*=") or word and code:find("[\"']" .. word .. "[\"']") then
      best = line
      break
    end
    if code:find("[%.%s]problem%s*[{(]") then best = line end
  end
  if file then file:close() end
  return best and ("%s:%d: %s"):format(name, best, message) or ("%s: %s"):format(name, message)
end

local function ask(case)
  local begun = process.clock()
  local answer, work = hooke.ask(case.scene, case.question, case.argument, { threads = 1, stand_in = case.stand_in })
  if not answer then return { failed = located(work, case.scene) } end
  return { answer = answer, work = work, seconds = process.clock() - begun }
end

-- The questions to the problem itself, `jobs` at a time.
local function ask_all(questions, jobs, done, tick)
  local k = 0
  case_process.each(jobs, function()
    k = k + 1
    local q = questions[k]
    return q and { scene = q.problem.path, question = q.question, argument = q.argument or {}, stand_in = q.stand_in,
      timeout = q.timeout, execute = ask, asked = q }
  end, function(case, result) done(case.asked, result) end, tick)
end

-- Of the questions whose problems ask a command first: what it has found becomes at.found of the question.
local function ask_commands(questions, jobs, done, tick)
  local first, wanted = {}, {}
  for k, q in ipairs(questions) do
    first[k] = { problem = q.problem, question = "asks", argument = q.argument, timeout = q.timeout, whole = q }
  end
  ask_all(first, jobs, function(q, result)
    if not result.answer then return done(q.whole, result) end
    wanted[#wanted + 1] = { scene = q.problem.path, asks = result.answer, execute = tool_runs.execute, trust = true,
      timeout = q.timeout, asked = q.whole }
  end, tick)
  local k, ready = 0, {}
  case_process.each(jobs, function()
    k = k + 1
    return wanted[k]
  end, function(case, result)
    if not result.found then return done(case.asked, { failed = located(result.failed, case.scene) }) end
    case.asked.argument.found = result.found
    ready[#ready + 1] = case.asked
  end, tick)
  ask_all(ready, jobs, done, tick)
end

-- Asks many questions, `jobs` at a time. A question: { problem =, question = "describe" or "solve", argument =,
-- stand_in =, timeout = }. done(question, result) with result.failed or result.answer, .work and .seconds.
function problems.ask(questions, jobs, done, tick)
  local plain, with_commands = {}, {}
  for _, q in ipairs(questions) do
    local d = q.question == "solve" and q.problem.description
    local list = d and d.asks and with_commands or plain
    list[#list + 1] = q
  end
  ask_all(plain, jobs, done, tick)
  ask_commands(with_commands, jobs, done, tick)
end

return problems
