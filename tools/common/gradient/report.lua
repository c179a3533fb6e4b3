-- What `hooke gradient` has found: words on standard output, gradient.json, and where it went forwards gradient.csv and a
-- diagram of the sensitivity in time.
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local files = require("common.run.file")
local journal = require("common.bench.journal")
local plot = require("common.run.plot")

local report = {}

-- A derivative by whole runs may differ so much from that of the steps, relative, beside what the differences cost.
local kink = 1e-3

local function short(x) return x and x == x and ("%.2g"):format(x) or "not known" end

-- Sentences on what is not as it should be.
function report.doubts(o, found)
  local list = { found.inaccurate and "the run itself is inaccurate: " .. found.inaccurate }
  for j, p in ipairs(o.parameters) do
    local slope, runs, least = found.slopes[j], found.runs[j], 10 * found.rounding[j] + found.noise[j]
    if runs ~= runs then
      list[#list + 1] = ("%s: a run beside does not reach the end"):format(p.name)
    elseif math.abs(runs - slope) > kink * math.max(math.abs(slope), math.abs(runs)) + least then
      list[#list + 1] = (("%s: whole runs beside give %.6g: a kink (a rope that goes slack, a contact), an event or motion "
        .. "without order lies between; the derivative holds on this side alone"):format(p.name, runs))
    end
    if found.by_steps[j] and found.by_steps[j] > 0.1 * math.abs(slope) and found.by_steps[j] > least then
      list[#list + 1] = ("%s: half the step changes it by a tenth or more: --dt below %.3g"):format(p.name, found.dt)
    end
  end
  if found.unrefined then list[#list + 1] = "the part of the steps is not known: " .. found.unrefined end
  return list
end

local function print_words(o, found)
  print(("%s: %s at t = %.9g s (%s, %d steps of %s%.4g s, %s, states of %.2g MB)"):format(o.scene:match("([^/]+)$"), o.of, o.at,
    o.plugin, found.steps, found.tol and "at most " or "", found.dt, o.backwards and "backwards" or "forwards", found.bytes / 1e6))
  print(("  %s = %.12g"):format(o.of, found.value))
  print(("  %-16s %14s %20s %12s %12s"):format("parameter", "value", "derivative", "by steps", "by rounding"))
  for j, p in ipairs(o.parameters) do
    print(("  %-16s %14.9g %20.12g %12s %12s  %s"):format(p.name, p.start, found.slopes[j], short(found.by_steps[j]),
      short(found.rounding[j]), p.help or ""))
  end
  if found.inexact then
    print(("  the force '%s' states no exact Jacobian: differences along the change take its place"):format(found.inexact))
  end
  for _, text in ipairs(found.doubts) do print("  not sure: " .. text) end
end

local function plain(x) return x and x == x and math.abs(x) < math.huge and x or journal.json.null end

local function json_text(o, found)
  local list = {}
  for j, p in ipairs(o.parameters) do
    list[j] = { name = p.name, value = p.start, derivative = plain(found.slopes[j]), by_steps = plain(found.by_steps[j]),
      by_rounding = plain(found.rounding[j]), by_runs = plain(found.runs[j]) }
  end
  return journal.json.encode { scene = o.scene, measure = o.of, t = o.at, value = found.value, integrator = o.plugin,
    dt = found.dt, steps = found.steps, sure = #found.doubts == 0, parameters = list,
    doubts = #found.doubts > 0 and found.doubts or journal.json.empty_array }
end

local function csv_text(o, found)
  local head = { "t", csv.text(o.of) }
  for j, p in ipairs(o.parameters) do head[2 + j] = "by_" .. p.name end
  local lines = { table.concat(head, ",") }
  for k, row in ipairs(found.rows) do
    local cells = {}
    for e, x in ipairs(row) do cells[e] = csv.cell(x) end
    lines[k + 1] = table.concat(cells, ",")
  end
  return table.concat(lines, "\n") .. "\n"
end

-- By how much the measure changes where a parameter doubles, linearly: curves of one unit.
local function draw(o, found)
  local curves = {}
  for j, p in ipairs(o.parameters) do
    curves[j] = { title = p.name, points = {}, lines = true }
    for k, row in ipairs(found.rows) do curves[j].points[k] = { row[1], row[2 + j] * (p.start ~= 0 and p.start or 1) } end
  end
  return plot.draw(o.out .. "/gradient", { title = ("%s: sensitivity of %s"):format(o.scene:match("([^/]+)$"), o.of),
    x = { label = "t, s" }, y = { label = ("d(%s)/d(ln parameter)"):format(o.of) }, curves = curves })
end

-- Prints and writes everything; or nil and why not.
function report.write(o, found)
  local fine, why = files.write(o.out .. "/gradient.json", json_text(o, found) .. "\n")
  if fine and found.rows then fine, why = files.write(o.out .. "/gradient.csv", csv_text(o, found)) end
  if fine and found.rows then fine, why = draw(o, found) end
  if o.json then command_line.print_json(json_text(o, found)) else
    print_words(o, found)
    print(("wrote %s/gradient.json%s"):format(o.out, found.rows and ", gradient.csv and a diagram in time" or ""))
  end
  return fine, why
end

return report
