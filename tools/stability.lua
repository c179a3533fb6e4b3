-- hooke stability [SCENE.lua]: the largest stable steps, measured; --hard: the corpus of hard cases.
-- Without a scene those of every integrator on the linear oscillator, beside theory; on a scene beside the estimate that
-- a run without dt uses. --hard [DIR] runs the corpus of hard cases with every integrator.
-- The methods of measurement are described in stability_region.lua, largest_step.lua and hard.lua of common/stability.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local files = require("common.run.file")
local json = require("cjson").new()
local lfs = require("lfs")
local process = require("process")

json.encode_invalid_numbers(true)

local function fail(message)
  return command_line.complain("stability", message)
end

-- ---- the command line ----

local function split(text)
  local list = {}
  for word in text:gmatch("[^,]+") do list[#list + 1] = word end
  return list
end

local function parser_of()
  local p = argparse("hooke stability", "Largest stable steps, measured; and the corpus of hard cases (--hard).")
  p:argument("scene", "a scene, then name=value; with --hard the folder of cases (tests/hard)"):args("*")
  p:option("--integrators", "only these: a,b,c"):convert(split)
  p:option("-j --jobs", "processes at a time"):convert(command_line.whole("-j"))
  p:option("--out", "folder for table and pictures (out/stability)")
  p:option("--over", "a ladder: NAME=VALUE,VALUE,...; may be repeated"):count("*")
  p:option("--csv", "also write the rows to this file")
  p:flag("--json", "print the rows as JSON, and nothing else on standard output")
  p:flag("--quiet", "no progress")
  p:flag("--hard", "run the corpus of hard cases")
  p:flag("--long", "with --hard: the long cases as well, and no limit of steps")
  p:flag("--reasons", "with --hard: say of every run how it ended")
  p:option("--case", "with --hard: only this case; may be repeated"):count("*")
  p:option("--part", "with --hard: K/N, every N-th run, beginning with the K-th")
  p:flag("--trust", "with --hard and a folder: its cases may use plugins")
  p:option("--timeout", "with --hard: seconds that a run may take"):convert(command_line.number("--timeout"))
  return p
end

local function parse()
  local o = command_line.parse("stability", parser_of())
  if not o then return nil end
  local why
  o.path, o.given, why = command_line.scene(o.scene)
  if why then return nil, why end
  if next(o.given) and (o.hard or not o.path) then return nil, "name=value is for a scene" end
  o.jobs = o.jobs or process.processors()
  o.out = o.out or "out/stability"
  return o
end

local function chosen_integrators(o)
  local all, found = {}, {}
  for _, plugin in ipairs((hooke.catalogue())) do
    if plugin.kind == "integrator" then
      all[#all + 1] = plugin
      found[plugin.name] = plugin
    end
  end
  local class = function(p) return (p.implicit and 2 or 0) + (p.adaptive and 1 or 0) end
  table.sort(all, function(a, b)
    if class(a) ~= class(b) then return class(a) < class(b) end
    return a.order < b.order or a.order == b.order and a.name < b.name
  end)
  local names = {}
  for k, plugin in ipairs(all) do names[k] = plugin.name end
  if not o.integrators then return all, names, names end
  local chosen = {}
  for k, name in ipairs(o.integrators) do
    if not found[name] then
      local near = hooke.nearest(name, names)
      return nil, ("--integrators: there is no '%s'%s"):format(name, near and (", did you mean '%s'?"):format(near) or "")
    end
    chosen[k] = found[name]
  end
  return chosen, o.integrators, names
end

-- ---- writing ----

local function csv_of(columns, rows)
  local lines = { table.concat(columns, ",") }
  for _, row in ipairs(rows) do
    local cells = {}
    for k, column in ipairs(columns) do cells[k] = csv.cell(row[column], "%.9g") end
    lines[#lines + 1] = table.concat(cells, ",")
  end
  return table.concat(lines, "\n") .. "\n"
end

-- ---- the corpus ----

local function print_hard(o, hard, cases, names, cells)
  local count = hard.counts(cells)
  print(hard.matrix(cases, names, cells))
  print("\n" .. hard.legend)
  local also = {}
  for _, cell in ipairs(cells) do
    if o.reasons or cell.run.text then also[#also + 1] = "  " .. hard.describe(cell) end
  end
  if #also > 0 then print((o.reasons and "\nall runs\n" or "\nwith given settings\n") .. table.concat(also, "\n")) end
  print("\nslowest")
  for _, cell in ipairs(hard.slowest(cells, 8)) do
    print(("  %6.2f s  %-20s %s"):format(cell.result.process_s, cell.case.name, cell.run.text or cell.run.integrator))
  end
  print(("\n%d cases, %d runs: %d ok, %d said they are not, %d above the limit of steps, %d do not fit; %d failed"):format(
    #cases, #cells, count.ok, count.said, count.limit, count.unfit, count.failed))
  for _, cell in ipairs(cells) do
    if cell.failed then print("  " .. hard.describe(cell)) end
  end
end

-- The corpus of the sources that this hooke was built from.
local function corpus() return hooke.folder .. "/../tests/hard" end

-- Cases whose plugins are not built, or not trusted, are left out, with a word.
local function buildable(cases, hard)
  local kept, without, missing = {}, {}, nil
  for _, case in ipairs(cases) do
    local name = hard.missing(case)
    missing = missing or name
    table.insert(name and without or kept, name and case.name or case)
  end
  if missing then
    io.stderr:write(("hooke: stability: %d of %d cases are left out (%s): their plugins for tests, such as %s, are not "
      .. "built; make test-programs builds them\n"):format(#without, #cases, table.concat(without, ", "), missing))
  end
  return kept
end

-- Cases that name plugins by their paths are for whoever trusts them.
local function allowed(o, cases)
  local kept, without = {}, {}
  for _, case in ipairs(cases) do
    local strange = case.trust and not o.trust
    table.insert(strange and without or kept, strange and case.name or case)
  end
  if #without > 0 then
    io.stderr:write(("hooke: stability: %d of %d cases are left out (%s): they use plugins by their paths, which --trust "
      .. "allows\n"):format(#without, #cases, table.concat(without, ", ")))
  end
  return kept
end

local function chosen_cases(o, hard)
  local cases, why = hard.cases(o.path or corpus())
  if not cases then return nil, why end
  local kept, names, found = {}, {}, {}
  for k, case in ipairs(cases) do names[k], found[case.name] = case.name, case end
  for _, name in ipairs(o.case) do
    if not found[name] then
      local near = hooke.nearest(name, names)
      return nil, ("--case: there is no '%s'%s"):format(name, near and (", did you mean '%s'?"):format(near) or "")
    end
    kept[#kept + 1] = found[name]
  end
  if #o.case > 0 then return allowed(o, buildable(kept, hard)) end
  for _, case in ipairs(cases) do
    if o.long or not case.long then kept[#kept + 1] = case end
  end
  return allowed(o, buildable(kept, hard))
end

-- Every run of o.part = "K/N"; nil and why.
local function part_of(cells, o)
  if not o.part then return cells end
  local first, step = o.part:match("^(%d+)/(%d+)$")
  first, step = tonumber(first), tonumber(step)
  if not first or first < 1 or first > step then return nil, "--part: give K/N with 1 <= K <= N, as in 1/4" end
  local kept = {}
  for k = first, #cells, step do kept[#kept + 1] = cells[k] end
  return kept
end

local function run_hard(o)
  local hard, progress = require("common.stability.hard"), require("common.run.progress")
  local _, names, all = chosen_integrators(o)
  if not all then return fail(names) end
  o.trust = o.trust or not o.path -- the corpus of hooke's own sources
  local cases, why = chosen_cases(o, hard)
  if cases then why = select(2, hard.check(cases, all)) end
  if why then return fail(why) end
  o.timeout = o.timeout or (o.long and 600 or 60)
  local cells, refused = part_of(hard.cells(cases, names, o), o)
  if not cells then return fail(refused) end
  local bar = progress.new { what = "hard cases", total = #cells, quiet = o.quiet or o.json }
  hard.run(cells, o.jobs, function(cell) bar:add { failed = cell.failed } end, function() bar:tick() end)
  bar:finish()
  if o.json then command_line.print_json(hard.json(cells)) else print_hard(o, hard, cases, names, cells) end
  local rows = {}
  for k, cell in ipairs(cells) do rows[k] = hard.row(cell) end
  if o.csv then
    local fine, reason = files.write(o.csv, csv_of(hard.columns, rows))
    if not fine then fail(reason) return 4 end
  end
  return hard.counts(cells).failed > 0 and 1 or 0
end

-- ---- the linear oscillator ----

local function ready_folder(path)
  local built = path:sub(1, 1) == "/" and "" or "."
  for part in path:gmatch("[^/]+") do
    built = built .. "/" .. part
    if lfs.attributes(built, "mode") ~= "directory" then
      local fine, refused = lfs.mkdir(built)
      if not fine then return nil, ("%s cannot be made: %s"):format(built, refused) end
    end
  end
  return true
end

local function report_write_error(message)
  fail(message)
  return 4
end

-- Writes the rows as CSV and, on request, JSON; returns nil on success, otherwise the exit code.
local function write_rows(o, name, columns, rows)
  local fine, refused = ready_folder(o.out)
  if fine then fine, refused = files.write(o.csv or o.out .. "/" .. name .. ".csv", csv_of(columns, rows)) end
  if o.json then command_line.print_json(json.encode(rows)) end
  if not fine then return report_write_error(refused) end
end

local function say_pictures(o, name, drawn, refused)
  if not drawn then fail(refused)
  elseif not o.json then print(("\nwrote %s/%s.csv, .png and .svg"):format(o.out, name)) end
end

local function run_linear(o)
  local stability_region, progress = require("common.stability.stability_region"), require("common.run.progress")
  local region_picture = require("common.stability.region_picture")
  local plugins, refused = chosen_integrators(o)
  if not plugins then return fail(refused) end
  local bar = progress.new { what = "integrators", total = #plugins, quiet = o.quiet or o.json }
  local rows = stability_region.all(plugins, o.jobs, function(plugin) bar:add { note = plugin.name } end, function() bar:tick() end)
  bar:finish()
  if not o.json then print(stability_region.table(rows)) end
  local code = write_rows(o, "linear", stability_region.columns, stability_region.rows(rows))
  if code then return code end
  say_pictures(o, "linear", region_picture.draw(o.out .. "/linear", plugins))
  local wrong = stability_region.overstated(rows)
  for _, line in ipairs(wrong) do fail(line) end
  return #wrong > 0 and 1 or 0
end

-- ---- a scene ----

local function ladders_of(o, largest_step)
  local ladders = {}
  for k, text in ipairs(o.over) do
    local ladder, refused = largest_step.ladder(text)
    if not ladder then return nil, refused end
    ladders[k] = ladder
  end
  return #ladders > 0 and ladders or largest_step.usual(o.path, o.given)
end

local function run_scene(o)
  local largest_step, progress = require("common.stability.largest_step"), require("common.run.progress")
  local plugins, refused = chosen_integrators(o)
  if not plugins then return fail(refused) end
  local ladders, tasks
  ladders, refused = ladders_of(o, largest_step)
  if ladders then tasks, refused = largest_step.tasks(o.path, o.given, ladders, plugins) end
  if not tasks then return fail(refused) end
  local bar = progress.new { what = "limits", total = #tasks, quiet = o.quiet or o.json }
  largest_step.run(tasks, o.jobs, function(task) bar:add { note = task.integrator } end, function() bar:tick() end)
  bar:finish()
  if not o.json then print(largest_step.table(tasks)) end
  local rows = {}
  for k, task in ipairs(tasks) do rows[k] = largest_step.row(task) end
  local code = write_rows(o, "limits", largest_step.columns, rows)
  if code then return code end
  say_pictures(o, "limits", largest_step.draw(o.out .. "/limits", tasks))
  local wrong = largest_step.wrong(tasks)
  for _, line in ipairs(wrong) do fail(line) end
  return #wrong > 0 and 1 or 0
end

local o, why = parse()
if not o then return why and fail(why) or 1 end
if o.hard then return run_hard(o) end
if o.path then return run_scene(o) end
return run_linear(o)
