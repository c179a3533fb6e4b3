-- hooke validate [TOPIC or FILE.lua] [NAME]: problems with known answers: orders, figures, a page.
-- Each is computed at several resolutions and steps; there is one line for each quantity, figures and a page to put into
-- a paper. See scripts/validation/README.md for the form of a problem,
-- and tools/common/validate: problems.lua (finding and asking), study.lua (levels and judgement), convergence.lua
-- (orders and extrapolation), lines.lua and page.lua (what is printed, drawn and written).
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local lines = require("common.validate.lines")
local page = require("common.validate.page")
local problems = require("common.validate.problems")
local process = require("process")
local progress = require("common.run.progress")
local study = require("common.validate.study")

local inaccurate = 5 -- the exit code of `hooke run` for a result that is known to be inaccurate
local default_timeout = 300 -- s, of one level of one problem

local function complain(format, ...)
  return command_line.complain("validate", format:format(...))
end

local function parser()
  local p = argparse("hooke validate", "Problems with known answers, at several resolutions and steps.")
  p:argument("topic", "a topic, a file of your own, or nothing: all"):args("?")
  p:argument("name", "one problem of the topic"):args("?")
  p:flag("--quick", "the short form: coarse levels, as make test runs them")
  p:flag("--levels", "prints the value at every level, too")
  p:flag("--list", "the problems, and nothing is run")
  p:option("-j --jobs", "levels at a time"):convert(command_line.whole("-j"))
  p:option("--plugin", "a force of your own (X.so) in the place of one of the engine's")
  p:option("--as", "of which force; left out: of its namesake, or of the only one whose parameters it has"):target("as")
  p:option("--timeout", ("s, of one level (%d)"):format(default_timeout)):convert(command_line.number("--timeout"))
  p:option("--out", "where the page and the figures go"):default("out/validate")
  p:flag("--no-page", "prints only"):target("no_page")
  p:flag("--quiet", "no progress")
  return p
end

-- ---- which problems ----

local function unknown(what, word, names)
  local near = hooke.nearest(word, names)
  return complain("there is no %s '%s'%s", what, word, near and ("; did you mean '%s'?"):format(near)
    or ("; there are " .. table.concat(names, ", ")))
end

local function chosen(o, root)
  if o.topic and o.topic:match("%.lua$") then
    if not io.open(o.topic) then return nil, complain("cannot read %s: no such file", o.topic) end
    return { problems.at(o.topic) }
  end
  local list, names = {}, {}
  for _, problem in ipairs(problems.all(root)) do
    if not o.topic or problem.topic == o.topic then
      names[#names + 1] = problem.name
      if not o.name or problem.name == o.name then list[#list + 1] = problem end
    end
  end
  if o.topic and #names == 0 then return nil, unknown("topic", o.topic, problems.topics(root)) end
  if #list == 0 then return nil, unknown("problem", o.name or "", names) end
  return list
end

-- Sets problem.description, or problem.failed.
local function describe(list, jobs)
  local questions = {}
  for k, problem in ipairs(list) do questions[k] = { problem = problem, question = "describe", timeout = 60 } end
  problems.ask(questions, jobs, function(q, result)
    q.problem.description, q.problem.failed = result.answer, result.failed
    q.problem.title = result.answer and result.answer.title
  end)
end

local function refused(list)
  local count = 0
  for _, problem in ipairs(list) do
    if problem.failed then
      complain("%s", problem.failed)
      count = count + 1
    end
  end
  return count
end

-- Problems with `quick = false` have no short form.
local function with_short_form(list)
  local rest = {}
  for _, problem in ipairs(list) do
    if problem.description.quick ~= false then rest[#rest + 1] = problem end
  end
  return rest
end

-- ---- a plugin in the place of a force ----

local function has_all(plugin, params)
  local known = {}
  for _, param in ipairs(plugin.params) do known[param.name] = true end
  for _, name in ipairs(params) do
    if not known[name] then return false end
  end
  return true
end

-- The sentence on a force or parameter that a problem names and nobody has; nil: all are there.
local function misnamed(list)
  local known, names = {}, {}
  for _, plugin in ipairs(hooke.catalogue()) do
    if plugin.kind == "force" then known[plugin.name], names[#names + 1] = plugin, plugin.name end
  end
  for _, problem in ipairs(list) do
    for force, params in pairs(problem.description.forces or {}) do
      if not known[force] then
        local near = hooke.nearest(force, names)
        return ("%s: forces: there is no force '%s'%s"):format(problem.path, force,
          near and ("; did you mean '%s'?"):format(near) or "")
      end
      if not has_all(known[force], params) then
        return ("%s: forces: %s has not all of the parameters %s"):format(problem.path, force, table.concat(params, ", "))
      end
    end
  end
end

-- The force that the plugin stands in for: the one that is asked for, its namesake, or the only one whose parameters it
-- has; nil and a sentence where that is not clear.
local function replaced(plugin, list, as)
  local fits, names, all = {}, {}, {}
  for _, problem in ipairs(list) do
    for force, params in pairs(problem.description.forces or {}) do
      all[("%s (%s)"):format(force, table.concat(params, ", "))] = true
      if not fits[force] and has_all(plugin, params) then fits[force], names[#names + 1] = true, force end
    end
  end
  if as or fits[plugin.name] then names = { fits[as or plugin.name] and (as or plugin.name) } end
  table.sort(names)
  if #names == 1 then return names[1] end
  if #names > 1 then
    return nil, ("%s has the parameters of %s: --as says in the place of which it is tried"):format(plugin.name,
      table.concat(names, " and of "))
  end
  local forces = {}
  for text in pairs(all) do forces[#forces + 1] = text end
  table.sort(forces)
  return nil, ("%s can stand in nowhere here%s: it needs all parameters of a force that may be replaced: %s"):format(
    plugin.name, as and " as " .. as or "", table.concat(forces, "; "))
end

-- The problems, each with its stand_in, in which the plugin can be a force; or nil and the exit code.
local function with_plugin(list, o)
  local plugin, why = hooke.describe(o.plugin)
  if not plugin then return nil, complain("%s", why) end
  why = misnamed(list)
  if why then return nil, complain("%s", why) end
  if plugin.kind ~= "force" then return nil, complain("%s: its kind is %s; a force can stand in", o.plugin, plugin.kind) end
  local force
  force, why = replaced(plugin, list, o.as)
  if not force then return nil, complain("%s", why) end
  local fitting = {}
  for _, problem in ipairs(list) do
    local params = (problem.description.forces or {})[force]
    if params and has_all(plugin, params) then
      local copy = {}
      for key, value in pairs(problem) do copy[key] = value end
      copy.stand_in = { force = force, path = plugin.path }
      copy.name = ("%s, %s for %s"):format(problem.name, plugin.name, force)
      copy.title = ("%s: %s for %s"):format(problem.title, plugin.name, force)
      fitting[#fitting + 1] = copy
    end
  end
  return fitting
end

-- ---- running ----

local function solve(list, o, jobs)
  local questions, run = {}, 0
  for _, problem in ipairs(list) do
    if problem.description then
      problem.levels = study.levels(problem.description, o.quick)
      problem.cells = study.cells(problem.levels, o.quick)
      problem.cost = { evaluations = 0, seconds = 0 }
      for _, cell in ipairs(problem.cells) do
        questions[#questions + 1] = { problem = problem, question = "solve", cell = cell, stand_in = problem.stand_in,
          argument = { n = cell.n, h = cell.h, quick = cell.quick or false },
          timeout = o.timeout or problem.description.timeout or default_timeout }
      end
    end
  end
  local bar = progress.new { what = "validate", total = #questions, quiet = o.quiet }
  problems.ask(questions, jobs, function(q, result)
    run = run + 1
    lines.take(q, result)
    bar:add { failed = result.failed ~= nil, note = q.problem.name }
  end, function() bar:tick() end)
  bar:finish()
  return run
end

local function judge(list, quick)
  for _, problem in ipairs(list) do
    problem.found = problem.failed and {} or study.results(problem.description, problem.levels, problem.cells, quick)
  end
end

local function main()
  local o = command_line.parse("validate", parser())
  if not o then return 1 end
  if o.as and not o.plugin then return complain("--as goes with --plugin: --plugin X.so --as %s", o.as) end
  local root = hooke.folder .. "/../scripts/validation"
  local list, code = chosen(o, root)
  if not list then return code end
  local jobs = o.jobs or process.processors()
  describe(list, jobs)
  if refused(list) > 0 then return 1 end
  if o.quick then
    list = with_short_form(list)
    if #list == 0 then return complain("none of these problems has a short form: leave --quick out") end
  end
  if o.plugin then
    list, code = with_plugin(list, o)
    if not list then return code end
  end
  if o.list then return lines.list(list) end
  solve(list, o, jobs)
  judge(list, o.quick)
  local wrong = lines.print(list, o.levels)
  if not o.no_page then
    local fine, why = page.write(list, o)
    if not fine then
      complain("%s", why)
      return 4
    end
    print(("wrote %s/validate.md, validate.csv and figures"):format(o.out))
  end
  return wrong > 0 and inaccurate or 0
end

return main()
