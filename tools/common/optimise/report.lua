-- What `hooke optimise` has found: words on standard output, optimum.json, and for every optimum the controls as a table and
-- as texts to run the scene with; and a page with a diagram of them.
local answer_page = require("common.run.answer_page")
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local derivative = require("common.gradient.derivative")
local description = require("common.run.description")
local files = require("common.run.file")
local journal = require("common.bench.journal")
local plot = require("common.run.plot")
local ranges = require("common.optimise.ranges")

local report = {}

local null = journal.json.null

local function plain(x) return x and x == x and math.abs(x) < math.huge and x or null end

-- What is missing of goal g, by what evaluation.lua says of it; nil: that is not known.
local function missed(goal, misses, g)
  if not misses then return nil end
  return goal.value and misses[g] or ranges.missed(goal, misses[g])
end

-- The scene's cost is a sum over frames: what a control does between two of them may cost nothing.
local function between_frames(o)
  for _, control in ipairs(o.controls) do
    local apart = control.duration / (#control.values - 1)
    if apart * o.fps < 1 - 1e-9 then
      return ("the cost is taken at frames, 1/%g s apart, and the knots of %s are %.6g s apart: fps = %d or more, or fewer knots"):format(
        o.fps, control.name, apart, math.ceil(1 / apart - 1e-9))
    end
  end
end

-- Sentences on what is not as it should be with an optimum.
function report.doubts(o, optimum)
  local list = {}
  if optimum.ended ~= "converged" then
    list[1] = ("it ended after %s%s"):format(optimum.ended, optimum.ended:find("--most", 1, true) and ": give --most more"
      or #o.goals == 0 and "; the cost has a kink or a jump there (particles that meet, a branch of its function)"
      or "; goals that contradict each other or are out of reach cannot be met")
  end
  local between = o.cost and between_frames(o)
  if between then list[#list + 1] = between end
  if optimum.unrefined then list[#list + 1] = "with more knots: " .. optimum.unrefined end
  if optimum.replay.failed then
    list[#list + 1] = ("%s does not run to the end with these controls: %s"):format(o.independent, optimum.replay.failed)
  end
  for g, goal in ipairs(o.goals) do
    local miss = missed(goal, optimum.replay.misses, g)
    if miss and math.abs(miss) > o.accuracy * math.max(goal.scale, optimum.reach[g]) then
      list[#list + 1] = ("%s misses %s %s by %.3g: shorter steps, --dt"):format(o.independent, goal.name, ranges.words(goal), miss)
    end
  end
  return list
end

-- How much the optimum would fall with endlessly many knots: the last halving's change and what follows it, at an order of 2 at
-- least; nil: it has not been refined.
local function error_by_knots(optimum)
  local levels = optimum.levels
  if not levels or #levels < 2 then return nil end
  return math.abs(levels[#levels].cost - levels[#levels - 1].cost) / 3
end

local function levels_of(optimum)
  local list = {}
  for k, level in ipairs(optimum.levels or {}) do list[k] = ("%d knots: %.12g"):format(level.knots, level.cost) end
  local off = error_by_knots(optimum)
  if off then list[#list + 1] = ("its error by the knots is %.2g at most"):format(off) end
  return list
end

local function title_of(o, k, optimum)
  return ("optimum %d: %.12g after %d iterations, from %d of %d starts"):format(k, optimum.cost, optimum.iterations,
    optimum.starts, o.starts + 1)
end

-- A row for each goal: what is asked, what is missing of it, and what by the independent method.
local function goals_of(o, optimum)
  local rows = {}
  for g, goal in ipairs(o.goals) do
    rows[g] = { goal.name, goal.value and ("%.9g"):format(goal.value) or ranges.words(goal), ("%.6g"):format(goal.at),
      ("%.2g"):format(missed(goal, optimum.misses, g)), ("%.2g"):format(missed(goal, optimum.replay.misses, g) or 0 / 0) }
  end
  return rows
end

local function print_optimum(o, k, optimum)
  print("  " .. title_of(o, k, optimum))
  for _, text in ipairs(levels_of(optimum)) do print("    " .. text) end
  for _, row in ipairs(goals_of(o, optimum)) do
    print(("    %-16s %14s at %s s, off by %10s, by %s %10s"):format(row[1], row[2], row[3], row[4], o.independent, row[5]))
  end
  for _, text in ipairs(optimum.doubts) do print("    not sure: " .. text) end
end

local function json_text(o, optima)
  local list = {}
  for k, optimum in ipairs(optima) do
    local controls, goals = {}, {}
    for j, control in ipairs(optimum.controls) do
      controls[j] = { name = control.name, duration = control.duration, values = control.values }
    end
    for g, goal in ipairs(o.goals) do
      goals[g] = { name = goal.name, value = plain(goal.value), min = plain(goal.min), max = plain(goal.max), at = goal.at,
        off = plain(missed(goal, optimum.misses, g)), replayed_off = plain(missed(goal, optimum.replay.misses, g)) }
    end
    list[k] = { cost = optimum.cost, levels = journal.list(optimum.levels or {}), error_by_knots = plain(error_by_knots(optimum)),
      iterations = optimum.iterations, starts = optimum.starts, ended = optimum.ended,
      goals = journal.list(goals), controls = controls, doubts = journal.list(optimum.doubts) }
  end
  return journal.encode { scene = o.scene, t = o.at, integrator = o.plugin, independent = o.independent, dt = plain(o.dt),
    optima = list, answer = o.answer == nil and null or o.answer, sure = #optima[1].doubts == 0 }
end

local function csv_text(controls)
  local lines = { "control,t,value" }
  for _, control in ipairs(controls) do
    for k, value in ipairs(control.values) do
      local t = (k - 1) / (#control.values - 1) * control.duration
      lines[#lines + 1] = table.concat({ csv.text(control.name), csv.cell(t), csv.cell(value) }, ",")
    end
  end
  return table.concat(lines, "\n") .. "\n"
end

-- The controls of this moment, as texts that the scene can be run with: what is left of a search that is ended.
function report.keep(o, controls, cost, missing)
  o.kept = { cost = cost, missing = missing }
  for _, control in ipairs(controls) do
    files.write(("%s/now-%s.txt"):format(o.out, control.name), derivative.control_text(control, 0) .. "\n")
  end
end

-- What is left of a search that is interrupted, behind that word. The best optimum of the starts before takes the place of the controls
-- of the moment.
function report.interrupted(o)
  if not o.memory then return " before its first run: nothing is kept, and the same command begins again" end
  local kept = ("what was evaluated is kept in %s/evaluations.json, from which the same command goes on"):format(o.out)
  if not o.kept then return (" before its first iteration: %s"):format(kept) end
  if o.best then report.keep(o, o.best.controls, o.best.cost) end
  local what = o.best and "the best optimum so far, with a cost of %.6g,"
    or ("the controls of the moment, with a cost of %%.6g and goals missed by %.2g,"):format(o.kept.missing)
  return (": %s stand%s in %s/now-%s.txt, and %s"):format(what:format(o.kept.cost), o.best and "s" or "", o.out,
    #o.controls == 1 and o.controls[1].name or "NAME", kept)
end

-- The name of a single control, and what the scene says of it, which has its unit.
local function axis_of(o)
  local control = o.controls[1]
  if #o.controls > 1 then return "control" end
  return control.help and control.help ~= "" and ("%s (%s)"):format(control.name, control.help) or control.name
end

local function draw(o, optima)
  local curves = {}
  for k, optimum in ipairs(optima) do
    for _, control in ipairs(optimum.controls) do
      local curve = { title = ("%s, %.6g"):format(control.name, optimum.cost), points = {}, lines = true }
      for j, value in ipairs(control.values) do
        curve.points[j] = { (j - 1) / (#control.values - 1) * control.duration, value }
      end
      if k <= 4 then curves[#curves + 1] = curve end
    end
  end
  return plot.draw(o.out .. "/controls", { title = ("%s: controls and their cost"):format(o.scene:match("([^/]+)$")),
    x = { label = "t, s" }, y = { label = axis_of(o) }, curves = curves })
end

-- Controls that go on behind the last goal count there, too: what a knot before it does, it does on both sides.
local function over_all(o)
  local longest = 0
  for _, control in ipairs(o.controls) do longest = math.max(longest, control.duration) end
  return longest > o.at * (1 + 1e-9) and (" over all of their %.9g s"):format(longest) or ""
end

local function head(o)
  return ("%s: least %s, to t = %.9g s (%s, steps of %.4g s)"):format(o.scene:match("([^/]+)$"), o.cost
    and "cost" or "integral of the squares of the controls" .. over_all(o), o.at, o.plugin, o.dt)
end

-- The command that runs the scene with the controls of the first optimum.
local function command(o, optima)
  local first = optima[1].controls[1].name
  return ("hooke run %s %s=\"$(cat %s/1-%s.txt)\""):format(o.scene, first, o.out, first)
end

-- The diagram and the page with it.
local function write_page(o, optima)
  local fine, why = draw(o, optima)
  if not fine then return nil, why end
  local tables, lines = {}, {}
  for k, optimum in ipairs(optima) do
    local rows = goals_of(o, optimum)
    table.insert(rows, 1, { "goal", "asked", "at, s", "off by", "by " .. o.independent })
    tables[k] = { title = title_of(o, k, optimum), rows = rows }
    for _, text in ipairs(levels_of(optimum)) do lines[#lines + 1] = ("optimum %d: %s"):format(k, text) end
    for _, text in ipairs(k > 1 and optimum.doubts or {}) do lines[#lines + 1] = ("optimum %d: not sure: %s"):format(k, text) end
  end
  lines[#lines + 1] = "run it: " .. command(o, optima)
  return answer_page.write(o.out .. "/page.html", { title = o.scene:match("([^/]+)$"), head = head(o), doubts = optima[1].doubts,
    tables = tables, lines = lines, figures = { { path = o.out .. "/controls", caption = "the controls" } } })
end

-- Prints and writes everything; or nil and why not.
function report.write(o, optima)
  o.answer, o.unanswered = description.answer("optimise", o, json_text(o, optima), "optima")
  local fine, why = files.write(o.out .. "/optimum.json", json_text(o, optima) .. "\n")
  for k, optimum in ipairs(optima) do
    if fine then fine, why = files.write(("%s/%d.csv"):format(o.out, k), csv_text(optimum.controls)) end
    for _, control in ipairs(optimum.controls) do
      local text = derivative.control_text(control, 0) .. "\n"
      if fine then fine, why = files.write(("%s/%d-%s.txt"):format(o.out, k, control.name), text) end
    end
  end
  if fine then fine, why = write_page(o, optima) end
  if o.json then
    command_line.print_json(json_text(o, optima))
    return fine and not o.unanswered, why or o.unanswered
  end
  print(head(o))
  for k, optimum in ipairs(optima) do print_optimum(o, k, optimum) end
  if o.answer ~= nil then print(table.concat(description.lines(o.answer), "\n")) end
  print("run it: " .. command(o, optima))
  return fine and not o.unanswered, why or o.unanswered
end

return report
