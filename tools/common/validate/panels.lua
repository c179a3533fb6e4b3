-- The figures of `hooke validate`: of each topic small multiples, a panel for each problem and axis, with every line of
-- convergence in it. Errors are those of each level, relative, against the reference; where both axes are refined, against
-- what the axis converges to, since the other one's error is the larger. A grey line has the expected order.
local lines = require("common.validate.lines")
local plot = require("common.run.plot")

local panels = {}

local columns = 3
local most_named = 4 -- quantities in a panel's legend
local most_letters = 32 -- of a quantity there
local title_letters = 40 -- in each of at most two lines

local function error_points(found, axis)
  local c, points = found[axis], {}
  local limit = (found.space and found.time) and c.value or found.quantity.reference
  for k, h in ipairs(c.h) do
    local off = math.abs(c.v[k] - limit) / found.quantity.scale
    if off > 0 then points[#points + 1] = { h, off } end
  end
  return points
end

-- A panel: title, label, ticks, curves (name, points), guide (order, and a point that it passes); nil: nothing to draw.
local function panel_of(problem, axis)
  local d = problem.description
  local panel = { curves = {}, title = problem.title, ticks = {},
    label = axis == "space" and (d.space_label or "n") or d.time_label or "step, s" }
  local worst
  for _, found in ipairs(problem.found) do
    local points = error_points(found, axis)
    if #points > 1 and not found[axis].exact then
      table.insert(panel.curves, { name = found.quantity.name, points = points,
        order = lines.order_text(found[axis]) })
      local first, expected = points[1], found.quantity.order[axis]
      if expected and (not worst or first[2] > worst) then
        worst = first[2]
        panel.guide = { order = expected, h = first[1], error = 2 * first[2] }
      end
    end
  end
  for k, x in ipairs(problem.levels[axis]) do
    panel.ticks[k] = axis == "space" and { 1 / x, ("%g"):format(x) } or { x, ("%.3g"):format(x) }
  end
  return #panel.curves > 0 and panel or nil
end

-- The panels of some problems, in their order.
function panels.of(list)
  local all = {}
  for _, problem in ipairs(list) do
    for _, axis in ipairs { "space", "time" } do
      local panel = not problem.failed and problem.levels[axis] and panel_of(problem, axis)
      if panel then all[#all + 1] = panel end
    end
  end
  return all
end

-- ---- gnuplot ----

function panels.data(all)
  local parts = {}
  for p, panel in ipairs(all) do
    for c, curve in ipairs(panel.curves) do parts[#parts + 1] = plot.block(("P%dC%d"):format(p, c), curve.points) end
  end
  return table.concat(parts, "\n") .. "\n"
end

function panels.shortened(text, most)
  if utf8.len(text) <= most then return text end
  return text:sub(1, utf8.offset(text, most - 2) - 1) .. "..."
end

-- Of more than can be named, these and those behind them are grey, and have one name together.
local function is_other(panel, c) return c >= most_named and #panel.curves > most_named end

local function curve_title(panel, c)
  if c > most_named then return "notitle" end
  local text = ("%s: %s"):format(panels.shortened(panel.curves[c].name, most_letters), panel.curves[c].order)
  if is_other(panel, c) then text = ("and %d more"):format(#panel.curves - c + 1) end
  return "title " .. plot.text(text) .. " noenhanced"
end

local function ticks_text(ticks)
  local parts = {}
  for k, tick in ipairs(ticks) do parts[k] = ("%s %.9g"):format(plot.text(tick[2]), tick[1]) end
  return table.concat(parts, ", ")
end

-- gnuplot's expression for a title, in two lines where it is long. (No double quotes around what a problem wrote: in them
-- backticks would run commands.)
local function title_text(title)
  local first = title
  for at in title:gmatch("()%s") do
    if utf8.len(title, 1, at - 1) <= title_letters then first = title:sub(1, at - 1) end
  end
  if utf8.len(title) <= title_letters or first == title then
    return plot.text(panels.shortened(title, title_letters + 4))
  end
  return plot.text(first) .. '."\\n".' .. plot.text(panels.shortened(title:sub(#first + 2), title_letters))
end

local function panel_script(panel, p)
  local text, items = {}, {}
  local function add(format, ...) text[#text + 1] = format:format(...) end
  local low, high = math.huge, 0
  for _, tick in ipairs(panel.ticks) do low, high = math.min(low, tick[1]), math.max(high, tick[1]) end
  add("set title %s noenhanced", title_text(panel.title))
  add("set xlabel %s noenhanced offset 0,0.3", plot.text(panel.label))
  local g = panel.guide
  local errors = plot.column(panel.curves, 2)
  for _, x in ipairs(g and { low / 1.25, high * 1.25 } or {}) do table.insert(errors, g.error * (x / g.h) ^ g.order) end
  add("set ytics auto; set yrange [*:*]") -- the panel before may have had others
  plot.axis("y", { log = true }, text, errors)
  plot.axis("x", { log = true, min = low / 1.25, max = high * 1.25 }, text, plot.column(panel.curves, 1))
  add("set xtics (%s)", ticks_text(panel.ticks))
  if g then items[1] = ("%.9g*(x/%.9g)**%g with lines lc rgb '#BBBBBB' lw 1 dt 1 title 'order %g'"):format(g.error, g.h,
    g.order, g.order) end
  for c in ipairs(panel.curves) do
    add(is_other(panel, c) and ("set style line %d lc rgb '#8A8A8A' lw 1 dt 1 pt 7"):format(c) or plot.style_line(c))
    items[#items + 1] = ("$P%dC%d using 1:2 with linespoints ls %d ps 0.5 %s"):format(p, c, c, curve_title(panel, c))
  end
  add("plot %s", table.concat(items, ", \\\n     "))
  return table.concat(text, "\n")
end

-- Commands that draw panels first to last into a grid of `rows`.
function panels.script(all, first, last, rows, title)
  local text = { "set tics nomirror scale 0.6", "set border 3 lw 0.8",
    "set grid ytics lc rgb '#DDDDDD' lt 1 lw 0.5", "set samples 2", "set ylabel 'relative error' offset 1,0",
    "set key below left Left reverse samplen 2 spacing 1 maxcols 1",
    ("set multiplot layout %d,%d title %s noenhanced"):format(rows, columns, plot.text(title)) }
  for p = first, last do text[#text + 1] = panel_script(all[p], p) end
  text[#text + 1] = "unset multiplot"
  return table.concat(text, "\n") .. "\n"
end

function panels.rows(count) return math.ceil(count / columns) end

return panels
