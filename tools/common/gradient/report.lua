-- What `hooke gradient` has found: words on standard output, gradient.json, and where it went forwards gradient.csv and a
-- diagram of the sensitivity in time.
local answer_page = require("common.run.answer_page")
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local files = require("common.run.file")
local journal = require("common.bench.journal")
local plot = require("common.run.plot")
local sides = require("common.gradient.sides")
local units = require("common.run.units")

local report = {}

-- A derivative by whole runs may differ so much from that of the steps, relative, beside what the differences cost.
local kink = 1e-3

local function short(x) return x and x == x and ("%.2g"):format(x) or "not known" end

-- From when on whole runs beside differ: the first frame after which all do. Nil: not known, backwards or by the same steps.
local function parted(found, j)
  local rows, beside = found.rows, found.beside[j]
  if not (rows and beside.slopes) then return nil end
  local since
  for k = #rows, 1, -1 do
    local slope, whole = rows[k][2 + j], beside.slopes[k]
    if not whole or math.abs(whole - slope) <= kink * math.max(math.abs(slope), math.abs(whole)) + beside.noise then break end
    since = rows[k][1]
  end
  return since
end

-- Why whole runs beside say something else.
local function kink_words(found, j)
  for _, step in ipairs(found.beside[j].steps) do
    if math.abs(step - found.dt) > 1e-9 * found.dt then
      return (("it changes the steps themselves, from %.9g s to %.9g s, and the derivative is at these steps: --dt %.9g keeps them"):format(
        found.dt, step, found.dt))
    end
  end
  local since = parted(found, j)
  return (("a kink (a rope that goes slack, a contact), an event or motion without order lies between%s; "
    .. "the derivative holds on this side alone"):format(since and (", by t = %.6g s"):format(since) or ""))
end

-- Whether differences of another width say something else, beyond rounding: the measure jumps, or has a kink in this state.
local function jumps(found, j)
  local wider, slope = found.wider[j], found.slopes[j]
  return wider and math.abs(wider - slope) > 0.01 * math.max(math.abs(slope), math.abs(wider)) + found.noise[j]
end

-- Whether whole runs say something else than the steps, at the end.
local function differs(found, j)
  local slope, runs = found.slopes[j], found.runs[j]
  local least = 10 * found.rounding[j] + found.noise[j]
  return runs == runs and math.abs(runs - slope) > kink * math.max(math.abs(slope), math.abs(runs)) + least
end

-- Whether the measure goes otherwise above than below this value, beyond rounding; at a smooth extremum, too.
local function bends(found, j)
  local beside = found.beside[j]
  if not beside.ends then return false end
  local above, below = (beside.ends[1] - found.value) / beside.by, (found.value - beside.ends[2]) / beside.by
  return math.abs(above - below) > kink * math.max(math.abs(above), math.abs(below)) + 4 * beside.noise
end

-- Whether the derivative of the steps may be that of one side alone.
function report.suspects(found, j) return differs(found, j) or jumps(found, j) or bends(found, j) end

-- ---- both sides ----

local function side_text(p, side) return ("%s %s %.9g"):format(p.name, side < 0 and "below" or "above", p.start) end

-- Rows of the derivatives of each side, below the heads of the columns: of kinks and bounds. None: there are none.
local function side_rows(o, found)
  local rows = { { "one-sided derivative", "value", "error", "by steps" } }
  for j, p in ipairs(o.parameters) do
    local both = found.sides[j]
    local told = both and (both.kind == "kink" or both.kind == "bound")
    for _, side in ipairs(told and sides.each or {}) do
      local s = both[side]
      rows[#rows + 1] = { side_text(p, side), s.bound and "none: its bound is there" or ("%.12g"):format(s.slope),
        s.bound and "" or short(s.error), s.bound and "" or short(s.by_steps) }
    end
  end
  return #rows > 1 and rows or nil
end

-- Why no derivative is told: of what a run on one side says.
local function untold_words(found, both, p, since)
  local words
  for _, side in ipairs(sides.each) do
    local s = both[side]
    if s.unreached then words = ("a run %s it ends earlier: %s"):format(sides.name[side], s.unreached) end
    if s.jump and not words then
      words = ("the measure jumps just %s this value, from %.9g to %.9g, and has no derivative%s"):format(sides.name[side], found.value,
        found.value + s.jump, since and (": an event lies between, by t = %.6g s"):format(since) or "")
    end
  end
  words = words or ("from below %.6g with an error of %s, from above %.6g with %s: too far off to tell"):format(
    both[-1].slope or 0 / 0, short(both[-1].error), both[1].slope or 0 / 0, short(both[1].error))
  return ("%s: %s; take another value, or a smooth measure"):format(p.name, words)
end

-- Sentences on parameters that do nothing, which may be what was meant.
function report.remarks(o, found)
  local list = {}
  for j, p in ipairs(o.parameters) do
    local still = found.slopes[j] == 0 and (found.beside[j].slopes ~= nil or found.whole ~= nil)
    for _, slope in ipairs(found.beside[j].slopes or {}) do still = still and slope == 0 end
    still = still and not bends(found, j)
    if still then
      list[#list + 1] = ("%s changes nothing of '%s', at no frame: is it the parameter that is meant?"):format(p.name, o.of)
    end
  end
  return list
end

-- What whole runs say of one parameter beside the steps; nil: nothing else.
local function doubt_of(o, found, j)
  local p, both = o.parameters[j], found.sides[j]
  local kind = both and both.kind
  if kind == "kink" and both.of_steps then
    return (("%s: with half the step both sides are %s apart instead of %s: the kink is one of the steps; take shorter ones, --dt below "
      .. "%.3g"):format(p.name, short(both.of_steps), short(math.abs(both[1].slope - both[-1].slope)), found.dt))
  end
  if kind == "kink" or kind == "bound" then return nil end -- both sides are told
  if kind == "jump" or kind == "unknown" and found.whole then return untold_words(found, both, p, parted(found, j)) end
  if found.whole then return nil end
  local runs = found.runs[j]
  if runs ~= runs then
    return ("%s: a run with a little less or more of it ends earlier: %s"):format(p.name, found.beside[j].unreached)
  elseif differs(found, j) then return ("%s: whole runs beside give %.6g: %s"):format(p.name, runs, kink_words(found, j))
  elseif jumps(found, j) then
    return (("%s: differences four times as wide give %.6g: the measure jumps or has a kink at this value (a branch of "
      .. "its function); take another value, or a smooth measure"):format(p.name, found.wider[j]))
  elseif kind == "unknown" then return untold_words(found, both, p) end
end

-- Sentences on what is not as it should be.
function report.doubts(o, found)
  local list = { found.inaccurate and "the run itself is inaccurate: " .. found.inaccurate }
  for j, p in ipairs(o.parameters) do
    local slope = found.slopes[j]
    list[#list + 1] = doubt_of(o, found, j)
    if found.by_steps[j] and found.by_steps[j] > 0.1 * math.abs(slope) and
      found.by_steps[j] > 10 * found.rounding[j] + (found.noise[j] or 0) then
      list[#list + 1] = ("%s: half the step changes it by a tenth or more: --dt below %.3g"):format(p.name, found.dt)
    end
  end
  if found.unrefined then list[#list + 1] = "the part of the steps is not known: " .. found.unrefined end
  return list
end

local function head(o, found)
  if found.whole then
    return ("%s: %s at t = %.9g s (%s, %d steps of at most %.4g s, by whole runs on both sides)"):format(o.scene:match("([^/]+)$"), o.of,
      o.at, o.plugin, found.steps, found.dt)
  end
  return ("%s: %s at t = %.9g s (%s, %d steps of %s%.4g s, %s, states of %.2g MB)"):format(o.scene:match("([^/]+)$"), o.of, o.at,
    o.plugin, found.steps, found.tol and "at most " or "", found.dt, o.backwards and "backwards" or "forwards", found.bytes / 1e6)
end

-- The unit of the derivative by a parameter; nil: not said.
local function unit_of(o, p) return units.quotient(o.unit, p.unit) end

-- Of the derivatives by all controls; nil: not said, or not the same.
local function unit_of_knots(o)
  local unit
  for _, p in ipairs(o.parameters) do
    if p.values and (not unit_of(o, p) or unit and unit ~= unit_of(o, p)) then return nil end
    unit = unit or p.values and unit_of(o, p)
  end
  return unit
end

local function slope_text(found, j)
  local both = found.sides[j]
  if both and (both.kind == "kink" or both.kind == "bound") then return "one-sided" end
  return found.slopes[j] == found.slopes[j] and ("%.12g"):format(found.slopes[j]) or "none"
end

-- A row for each parameter, below the heads of the columns.
local function rows_of(o, found)
  local rows = { { "parameter", "value", "derivative", "by steps", "by rounding" } }
  for j, p in ipairs(o.parameters) do
    rows[1 + j] = { p.name, p.start and ("%.9g"):format(p.start) or ("%d knots"):format(#p.values), slope_text(found, j),
      short(found.by_steps[j]), short(found.rounding[j]),
      (unit_of(o, p) and "in " .. unit_of(o, p) .. "; " or "") .. (p.help or "all of it by as much") }
  end
  return rows
end

-- What is said below the parameters.
local function further(o, found)
  local list = {}
  if found.whole then list[1] = ("by whole runs beside it, extrapolated to the value itself: %s"):format(found.whole) end
  for j, p in ipairs(o.parameters) do
    local both, since = found.sides[j], found.rows and parted(found, j)
    if both and both.kind == "kink" then
      list[#list + 1] = (("%s: '%s' has a kink at this value (a branch, a contact, a slack rope): its derivatives from below and from "
        .. "above differ%s, and hold on their side alone"):format(p.name, o.of, since and (", from t = %.6g s on"):format(since) or ""))
    end
  end
  if found.inexact then
    list[#list + 1] = ("the force '%s' states no exact Jacobian: differences along the change take its place"):format(found.inexact)
  end
  return table.move(found.remarks, 1, #found.remarks, #list + 1, list)
end

local function print_words(o, found)
  print(head(o, found))
  print(("  %s = %.12g%s"):format(o.of, found.value, o.unit and " " .. o.unit or ""))
  for _, row in ipairs(rows_of(o, found)) do
    print(("  %-16s %14s %20s %12s %12s%s"):format(row[1], row[2], row[3], row[4], row[5], row[6] and "  " .. row[6] or ""))
  end
  for _, row in ipairs(side_rows(o, found) or {}) do print(("  %-32s %20s %12s %12s"):format(table.unpack(row))) end
  for _, text in ipairs(further(o, found)) do print("  " .. text) end
  for _, text in ipairs(found.doubts) do print("  not sure: " .. text) end
end

local function plain(x) return x and x == x and math.abs(x) < math.huge and x or journal.json.null end

-- { t, value, derivative by it } of the knots of a control.
local function knots_of(p, slopes)
  local list = {}
  for k, slope in ipairs(slopes or {}) do
    list[k] = { t = (k - 1) / (#slopes - 1) * p.duration, value = p.values[k], derivative = plain(slope) }
  end
  return list
end

-- One side of a parameter, null where nothing is known of it.
local function side_json(both, side)
  local s = both and both[side]
  local told = s and s.slope and (both.kind == "kink" or both.kind == "bound" or both.kind == "smooth")
  return told and { derivative = plain(s.slope), error = plain(s.error), by_steps = plain(s.by_steps) } or journal.json.null
end

local kinds = { kink = "one-sided", bound = "one-sided", jump = "none", unknown = "not known", smooth = "two-sided" }

local function json_text(o, found)
  local list = {}
  for j, p in ipairs(o.parameters) do
    list[j] = { name = p.name, value = plain(p.start), derivative_unit = unit_of(o, p) or journal.json.null,
      knots = journal.list(knots_of(p, found.knots[j])), derivative = plain(found.slopes[j]), by_steps = plain(found.by_steps[j]),
      by_rounding = plain(found.rounding[j]), by_runs = plain(found.runs[j]),
      kind = kinds[found.sides[j] and found.sides[j].kind or "smooth"], from_below = side_json(found.sides[j], -1),
      from_above = side_json(found.sides[j], 1) }
  end
  return journal.encode { scene = o.scene, measure = o.of, unit = o.unit or journal.json.null, t = o.at, value = found.value,
    integrator = o.plugin, dt = found.dt, steps = found.steps, sure = #found.doubts == 0, parameters = list,
    whole_runs = found.whole or journal.json.null,
    doubts = journal.list(found.doubts), remarks = journal.list(found.remarks) }
end

local function csv_text(o, found)
  local names = { "t", csv.text(o.of) }
  for j, p in ipairs(o.parameters) do names[2 + j] = "by_" .. p.name end
  local lines = { table.concat(names, ",") }
  for k, row in ipairs(found.rows) do
    local cells = {}
    for e, x in ipairs(row) do cells[e] = csv.cell(x) end
    lines[k + 1] = table.concat(cells, ",")
  end
  return table.concat(lines, "\n") .. "\n"
end

-- By the values of controls at their knots.
local function draw_knots(o, found)
  local curves = {}
  for j, p in ipairs(o.parameters) do
    local curve = { title = p.name, points = {}, lines = true, marks = true }
    for k, knot in ipairs(knots_of(p, found.knots[j])) do curve.points[k] = { knot.t, found.knots[j][k] } end
    if p.values then curves[#curves + 1] = curve end
  end
  return plot.draw(o.out .. "/gradient", { title = ("%s: sensitivity of %s at t = %.6g s"):format(o.scene:match("([^/]+)$"), o.of, o.at),
    x = { label = "t of the knot, s" }, curves = curves,
    y = { label = units.label(("d(%s)/d(value at the knot)"):format(o.of), unit_of_knots(o)) } })
end

-- By how much the measure changes where a parameter doubles, linearly: curves of one unit.
local function draw(o, found)
  local curves = {}
  for j, p in ipairs(o.parameters) do
    curves[j] = { title = p.name, points = {}, lines = true }
    for k, row in ipairs(found.rows) do curves[j].points[k] = { row[1], row[2 + j] * (p.start ~= 0 and p.start or 1) } end
  end
  return plot.draw(o.out .. "/gradient", { title = ("%s: sensitivity of %s"):format(o.scene:match("([^/]+)$"), o.of),
    x = { label = "t, s" }, y = { label = units.label(("d(%s)/d(ln parameter)"):format(o.of), o.unit) }, curves = curves })
end

-- The diagram and the page with it.
local function write_page(o, found)
  local fine, why, caption = true, nil, "in time: d(" .. o.of .. ")/d(ln parameter)"
  if found.rows then fine, why = draw(o, found)
  elseif o.by_controls then
    fine, why = draw_knots(o, found)
    caption = "by the values of the controls at their knots"
  end
  if not fine then return nil, why end
  local of_sides = side_rows(o, found)
  local figures = (found.rows or o.by_controls) and { { path = o.out .. "/gradient", caption = caption } } or {}
  return answer_page.write(o.out .. "/page.html", { title = ("%s: %s = %.9g"):format(o.scene:match("([^/]+)$"), o.of, found.value),
    head = head(o, found), doubts = found.doubts,
    tables = { { rows = rows_of(o, found) }, of_sides and { rows = of_sides } }, lines = further(o, found),
    figures = figures })
end

-- Prints and writes everything; or nil and why not.
function report.write(o, found)
  local fine, why = files.write(o.out .. "/gradient.json", json_text(o, found) .. "\n")
  if fine and found.rows then fine, why = files.write(o.out .. "/gradient.csv", csv_text(o, found)) end
  if fine then fine, why = write_page(o, found) end
  if o.json then command_line.print_json(json_text(o, found)) else
    print_words(o, found)
    print(("wrote %s/gradient.json%s"):format(o.out, found.rows and ", gradient.csv, page.html and its diagram in time"
      or o.by_controls and ", page.html and its diagram of the knots" or " and page.html"))
  end
  return fine, why
end

return report
