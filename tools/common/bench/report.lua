-- The evaluation of a bench's rows: observed orders, the Pareto front, the cheapest setting of every method at the
-- target, the recommendation; as text, CSV, JSON and a diagram.
local axes = require("common.run.axes")
local methods = require("common.bench.methods")
local plot = require("common.run.plot")
local csv = require("common.run.csv")
local files = require("common.run.file")
local journal = require("common.bench.journal")

local report = {}

local function trusted(row, goal)
  return row.verdict == "ok" and row.error and row.error == row.error and (row.error > 0 or goal.support > 0)
end

-- The text of an error, never below the smallest error that the reference can resolve.
local function error_text(value, support)
  if not value or value ~= value then return "-" end
  if value < support then return ("<%.1e"):format(support) end
  return ("%.2e"):format(value)
end

local function shown(row, goal) return math.max(row.error, goal.support) end

-- ---- orders ----

-- The slope of log error over log step, by least squares over the last rows (at most 4) that are above the support.
-- An adaptive method counts with its mean step.
function report.order(method, goal)
  local points = {}
  for _, row in ipairs(method.rows) do
    if row.error and row.error > 3 * goal.support and (row.verdict == "ok" or row.verdict == "inaccurate")
      and row.error < 0.1 * goal.scale then
      local step = row.setting.substeps and 1 / row.setting.substeps or 1 / row.result.steps
      points[#points + 1] = { math.log(step), math.log(row.error) }
    end
  end
  while #points > 4 do table.remove(points, 1) end
  local count = #points
  if count < 3 or points[1][1] - points[count][1] < math.log(2) then return nil end
  local mx, my, top, bottom = 0, 0, 0, 0
  for _, p in ipairs(points) do mx, my = mx + p[1] / count, my + p[2] / count end
  for _, p in ipairs(points) do top, bottom = top + (p[1] - mx) * (p[2] - my), bottom + (p[1] - mx) ^ 2 end
  return top / bottom
end

-- ---- ranking ----

local function all_rows(list)
  local rows = {}
  for _, method in ipairs(list) do
    for _, row in ipairs(method.rows) do rows[#rows + 1] = row end
  end
  return rows
end

function report.front(list, goal)
  local rows, best, front = {}, math.huge, {}
  for _, row in ipairs(all_rows(list)) do
    row.front = nil
    if trusted(row, goal) and row.wall_s then rows[#rows + 1] = row end
  end
  table.sort(rows, function(a, b) return a.wall_s < b.wall_s end)
  for _, row in ipairs(rows) do
    if shown(row, goal) < best then
      best, row.front = shown(row, goal), true
      front[#front + 1] = row
    end
  end
  return front
end

-- The cheapest row of a method that reaches the target, or its most accurate one.
local function row_at(method, goal, target)
  local chosen, closest, best
  for _, row in ipairs(method.rows) do
    if row.error and row.error == row.error and row.wall_s and (not best or row.error < best.error) then best = row end
    if trusted(row, goal) and row.wall_s then
      if shown(row, goal) <= target and (not chosen or row.wall_s < chosen.wall_s) then chosen = row end
      if not closest or shown(row, goal) < shown(closest, goal) then closest = row end
    end
  end
  return chosen, closest or best
end

-- One row per method, ordered by cost, those that reach the target first.
function report.ranking(list, goal)
  local target, ranking = math.max(goal.target, goal.support), {}
  for _, method in ipairs(list) do
    if not method.refused then
      local reached, closest = row_at(method, goal, target)
      ranking[#ranking + 1] = { method = method, row = reached or closest, reached = reached ~= nil }
    end
  end
  table.sort(ranking, function(a, b)
    if a.reached ~= b.reached then return a.reached end
    if not (a.row and b.row) then return a.row ~= nil and b.row == nil end
    if a.reached then return a.row.wall_s < b.row.wall_s end
    return a.row.error < b.row.error
  end)
  return ranking
end

local function phrase(row, goal)
  return ("%s, %s: %s %s%s at %.2g s per simulated second"):format(row.integrator, methods.setting_text(row.setting),
    goal.word, error_text(row.error, goal.support), goal.unit, row.wall_s / goal.seconds)
end

function report.recommend(ranking, goal)
  local first, second = ranking[1], ranking[2]
  if not (first and first.reached) then return nil, "no method reaches the target in the time given" end
  local text = phrase(first.row, goal)
  if second and second.reached then
    text = ("%s; the next is %s (%.2g times the time)"):format(text, phrase(second.row, goal),
      second.row.wall_s / first.row.wall_s)
  end
  return first.row, text
end

-- ---- text ----

local function order_text(method, order)
  local declared = ("%g"):format(method.order)
  return order and ("%.1f of %s"):format(order, declared) or "- of " .. declared
end

function report.weak_order(method, order)
  return order and not method.varies and order < method.order - 0.3
end

-- Detects an implicit method with fixed steps that took more steps than requested, since Newton's iteration failed and
-- steps were halved. Returns the longest step without halving, nil when every row has halvings, or false when none has.
function report.halved(method, goal)
  if not method.implicit or method.adaptive or method.by ~= "dt" then return false end
  local found, longest = false, nil
  for _, row in ipairs(method.rows) do
    local steps = row.result.steps or 0
    local whole = row.verdict == "ok" or row.verdict == "inaccurate"
    if whole and steps > math.ceil(goal.seconds / row.setting.dt * (1 - 1e-9)) + 1 then
      found = true
    elseif whole and not longest then
      longest = row.setting.dt
    end
  end
  return found and { longest = longest }
end

function report.table(ranking, goal, out)
  out:write(("\n  %-26s %-15s %9s %9s %9s %8s %9s %9s  %s\n"):format("method", "setting", "wall s", "evals", "lin.iter",
    "factor.", "error", "order", "verdict"))
  local line_drawn
  for _, entry in ipairs(ranking) do
    local row, method = entry.row, entry.method
    if not entry.reached and not line_drawn then
      out:write(("  -- above the target of %.1e%s, or with another verdict than ok:\n"):format(
        math.max(goal.target, goal.support), goal.unit))
      line_drawn = true
    end
    local order = order_text(method, method.observed)
    if row then
      out:write(("%s %-26s %-15s %9.3g %9d %9d %8d %9s %9s  %s\n"):format(row.front and "*" or " ", method.label,
        methods.setting_text(row.setting), row.wall_s, row.result.force_evaluations, row.result.linear_iterations,
        row.result.factorizations, error_text(row.error, goal.support), order, row.verdict))
    else
      local last = method.rows[#method.rows]
      out:write(("  %-26s %-15s %s: %s\n"):format(method.label, last and methods.setting_text(last.setting) or "",
        last and last.verdict or "not run", last and (last.reason or ""):gsub("%s+", " "):sub(1, 90) or ""))
    end
  end
  out:write("  * on the front: nothing measured is both faster and more accurate\n")
end

-- ---- files ----

-- error_x_rms (m): at a frame, the root mean square over all particles, pinned ones too, of the distance to the
-- reference (where the scene has an exact solution, over the particles whose positions it gives, of the distance to
-- that); of these numbers the root mean square over the frames after the start, the end included. error_x_max: the largest
-- distance of any particle at any of these frames. error_v_rms, error_v_max (m/s): the same for velocities.
local columns = { "integrator", "dt", "tol", "steps", "force_evaluations", "factorizations", "wall_s", "error_x_rms",
  "error_x_max", "error_v_rms", "energy_drift", "verdict", "error_v_max", "substeps", "jacobian_evaluations",
  "linear_iterations", "dt_min", "dt_max", "momentum_drift", "constraint_violation", "max_strain", "repeats",
  "pareto", "reason" }

-- A row as a flat table; errors below the support are nil, and NAME_below is the support.
function report.flat(row, goal)
  local r, flat = row.result, {}
  for _, key in ipairs { "steps", "force_evaluations", "factorizations", "jacobian_evaluations", "linear_iterations",
    "dt_min", "dt_max", "momentum_drift", "constraint_violation", "max_strain" } do flat[key] = r[key] end
  flat.integrator, flat.dt, flat.tol, flat.substeps = row.integrator, row.setting.dt, row.setting.tol, row.setting.substeps
  flat.wall_s, flat.verdict, flat.reason, flat.pareto = row.wall_s, row.verdict, row.reason, row.front and 1 or 0
  flat.energy_drift, flat.repeats = r.energy and r.energy.drift, #row.times
  local function put(name, value, support)
    if not value or value ~= value then return end
    if value < support then flat[name .. "_below"] = support else flat[name] = value end
  end
  if row.errors then
    put("error_x_rms", row.errors.x_rms, goal.supports.x_rms)
    put("error_x_max", row.errors.x_max, goal.supports.x_max)
    put("error_v_rms", row.errors.v_rms, goal.supports.v_rms)
    put("error_v_max", row.errors.v_max, goal.supports.v_max)
    for name, value in pairs(row.errors.measure) do
      put("error_" .. name, value, goal.supports.measure[name] or math.huge)
    end
  end
  return flat
end

-- A dt with 17 digits is the same number when it is read again: it gives the same steps.
local digits = { dt = "%.17g" }

local function cell(flat, column)
  local value = flat[column]
  if value == nil and flat[column .. "_below"] then return ("<%.3g"):format(flat[column .. "_below"]) end
  return csv.cell(type(value) == "string" and value:gsub("\n", " ") or value, digits[column] or "%.9g")
end

function report.csv(list, goal, path)
  local names, lines = table.move(columns, 1, #columns, 1, {}), {}
  local measures = {}
  for name in pairs(goal.supports.measure) do measures[#measures + 1] = "error_" .. name end
  table.sort(measures)
  table.move(measures, 1, #measures, #names + 1, names)
  local heads = {}
  for k, name in ipairs(names) do heads[k] = csv.text(name) end
  lines[1] = table.concat(heads, ",")
  for _, row in ipairs(all_rows(list)) do
    local flat, cells = report.flat(row, goal), {}
    for k, name in ipairs(names) do cells[k] = cell(flat, name) end
    lines[#lines + 1] = table.concat(cells, ",")
  end
  return files.write(path, table.concat(lines, "\n") .. "\n")
end

function report.json(list, goal, more, path)
  local whole = { rows = {}, methods = {} }
  for key, value in pairs(more) do whole[key] = value end
  for _, row in ipairs(all_rows(list)) do whole.rows[#whole.rows + 1] = report.flat(row, goal) end
  for _, method in ipairs(list) do
    whole.methods[#whole.methods + 1] = { integrator = method.label, order_declared = method.order,
      order_observed = method.observed, order_missed = report.weak_order(method, method.observed) or false,
      refused = method.refused, ended = method.ended }
  end
  return files.write(path, journal.json.encode(whole) .. "\n")
end

-- ---- the diagram ----

-- Of the errors below the floor only the cheapest row is drawn, on the floor.
local function curve_of(method, goal)
  local points, at_floor = {}, nil
  for _, row in ipairs(method.rows) do
    if row.verdict == "ok" and row.error and row.error < goal.scale and row.wall_s
      and math.max(row.error, goal.support) > 0 then
      local point = { math.max(row.error, goal.support), row.wall_s / goal.seconds, steps = row.result.steps }
      local last = points[#points]
      if last and point.steps == last.steps then table.remove(points) end -- a tolerance without effect
      if row.error < goal.support then
        if not at_floor or point[2] < at_floor[2] then at_floor = point end
      else
        points[#points + 1] = point
      end
    end
  end
  points[#points + 1] = at_floor
  return points
end

-- The next of 1, 2, 5, 10, ... below or above.
local function round_number(x, up)
  local power = 10 ^ math.floor(math.log(x, 10))
  local last = power
  for _, factor in ipairs { 1, 2, 5, 10 } do
    if up and factor * power >= x * (1 - 1e-9) then return factor * power end
    if not up and factor * power > x * (1 + 1e-9) then return last end
    last = factor * power
  end
  return last
end

local function bounds(curves, goal)
  local low, high, fast, slow = goal.target, goal.target, math.huge, 0
  for _, curve in ipairs(curves) do
    for _, p in ipairs(curve.points) do
      low, high = math.min(low, p[1]), math.max(high, p[1])
      fast, slow = math.min(fast, p[2]), math.max(slow, p[2])
    end
  end
  if low <= goal.support then low = low / 4 end -- space for the band
  return round_number(0.8 * low), round_number(1.25 * high, true), round_number(0.9 * fast),
    round_number(1.1 * slow, true)
end

-- Whether a setting of the method is on the front that was found last.
local function on_front(method)
  for _, row in ipairs(method.rows) do
    if row.front then return true end
  end
  return false
end

function report.draw(list, goal, chosen, path)
  local curves, front = {}, {}
  for k, row in ipairs(report.front(list, goal)) do
    front[k] = { math.max(row.error, goal.support), row.wall_s / goal.seconds }
  end
  for _, method in ipairs(list) do
    local points = curve_of(method, goal)
    local title = method.label:gsub(":method=", " "):gsub(":", " ")
    if #points > 0 then curves[#curves + 1] = { title = title, points = points, main = on_front(method) } end
  end
  if #curves == 0 then return nil, "no picture: there is no error to draw" end
  local low, high, fast, slow = bounds(curves, goal)
  local commands, more, data = {}, {}, {}
  if goal.support > low then
    commands[#commands + 1] = ("set object 1 rectangle from first %g, graph 0 to first %g, graph 1 behind "
      .. "fc rgb '#E4E4E4' fs solid noborder"):format(low, math.min(goal.support, high))
    commands[#commands + 1] = ("set label 1 'below the floor, %.1e%s' at first %g, graph 0.5 center rotate by 90 "
      .. "tc rgb '#555555' font ',10'"):format(goal.support, goal.unit, math.sqrt(low * math.min(goal.support, high)))
  end
  commands[#commands + 1] = ("set arrow 1 from first %g, graph 0 to first %g, graph 1 nohead dt (8,6) lw 1.6 "
    .. "lc rgb '#444444' front"):format(goal.target, goal.target)
  commands[#commands + 1] = ("set label 2 'target' at first %g, graph 0.975 offset 0.6,0 tc rgb '#444444' "
    .. "font ',10' front")
    :format(goal.target)
  if #front > 0 then
    data[1] = { name = "FRONT", rows = axes.staircase(front, high, slow) }
    more[1] = "$FRONT using 1:2 with lines lw 9 lc rgb '#DADADA' title 'nothing is better'"
  end
  if chosen then
    local point = { math.max(chosen.error, goal.support), chosen.wall_s / goal.seconds }
    data[#data + 1] = { name = "CHOSEN", rows = { point } }
    more[#more + 1] = "$CHOSEN using 1:2 with points pt 6 ps 3.4 lw 2.2 lc rgb '#000000' title 'recommended'"
  end
  return plot.draw(path, { title = goal.title, curves = curves, commands = commands, more = more, data = data,
    x = { label = goal.axis, log = true, min = low, max = high },
    y = { label = "wall time per simulated second, s (one thread)", log = true, min = fast, max = slow } })
end

report.said = error_text
return report
