-- Diagrams of a sweep: a measure against one parameter, or against another measure along one (a line for each combination
-- of the others; with `panels` a panel for each value of some, on the same axes), as colour over two parameters, or the paths
-- of a particle in panels. Repeats, and samples with equal
-- coordinates, are drawn as their median. Cases that diverged or failed are omitted, and the title gives their number.
local maps = require("common.sweep.maps")
local paths = require("common.sweep.paths")
local plan = require("common.sweep.plan")
local plot = require("common.run.plot")
local points = require("common.sweep.points")
local remarks = require("common.sweep.remarks")
local rows = require("common.sweep.table")

local figures = {}

-- ---- figures to draw ----

local known = { "measure", "over", "along", "repeats", "name", "title", "xlabel", "ylabel", "logx", "logy", "min", "max", "path", "axes",
  "panels", "curves", "range", "width", "height" }

local function check(figure, k)
  local names = {}
  for _, name in ipairs(known) do names[name] = true end
  for name in pairs(figure) do
    if not names[name] then plan.unknown("field of plots[" .. k .. "]", name, known) end
  end
  if not figure.measure and not figure.path then plan.refuse("plots[%d]: neither measure nor path", k) end
  local over = points.over(figure)
  if figure.measure and #over ~= 1 and #over ~= 2 then
    plan.refuse("plots[%d]: over: expected a parameter (lines) or two (a heat map)", k)
  end
  if figure.repeats and (not figure.along or figure.repeats ~= "least") then
    plan.refuse("plots[%d]: repeats: \"least\", of what is in `over`, beside `along`; the median otherwise", k)
  end
  if figure.panels and figure.measure and (#over ~= 1 or type(figure.panels) ~= "table") then
    plan.refuse("plots[%d]: panels: a list of parameters, a panel for each of their values, beside one parameter or measure in `over`", k)
  end
  if figure.along and #over ~= 1 then plan.refuse("plots[%d]: along: goes with one measure in `over`", k) end
end

-- Replaces control characters in texts, since a line break would end a command of gnuplot's script.
local function clean(figure)
  for key, value in pairs(figure) do
    if type(value) == "string" then figure[key] = value:gsub("%c", " ") end
  end
  return figure
end

local function parse(text)
  local measure, x, z = text:match("^(.-):([^,]+),?(.*)$")
  if not measure or measure == "" then plan.refuse("--plot: '%s' is not MEASURE:PARAMETER[,PARAMETER]", text) end
  return { measure = measure, over = z ~= "" and { x, z } or x }
end

-- The figures of the script and of the command line; figures that cannot be drawn are refused.
function figures.list(plots, asked, the)
  local list = {}
  for k, figure in ipairs(plots or {}) do
    check(figure, k)
    list[#list + 1] = clean(figure)
  end
  for _, text in ipairs(asked or {}) do list[#list + 1] = parse(text) end
  for _, figure in ipairs(list) do
    if figure.path then paths.check(the, figure)
    elseif #points.over(figure) == 2 then maps.check(the, figure)
    elseif figure.along and not points.axis(the, figure.along) then
      plan.refuse("plots: along: '%s' is not a parameter of the sweep", figure.along)
    end
    for _, name in ipairs(figure.measure and figure.panels or {}) do
      if not points.axis(the, name) then plan.refuse("plots: panels: '%s' is not a parameter of the sweep", tostring(name)) end
    end
  end
  return list
end

-- The names that a figure takes from the results.
function figures.measures(figure)
  if figure.path then return {} end
  return { figure.measure, table.unpack(points.over(figure)) }
end

-- ---- points ----

-- x and y at each value of the axis that the figure's lines go along, in its order.
local function points_along(cases, x, y, figure)
  local list = {}
  for _, group in ipairs(points.grouped(cases, { figure.along })) do
    local at, values = {}, {}
    for _, case in ipairs(group) do
      local a, b = rows.value(case, x), rows.value(case, y)
      if points.good(case) and type(a) == "number" and type(b) == "number" then at[#at + 1], values[#values + 1] = a, b end
    end
    if #at > 0 then list[#list + 1] = { points.of_repeats(figure, at), points.median(values) } end
  end
  return list
end

-- { { x, y }, ... }: the median where several cases have the same x.
local function points_of(cases, x, y)
  local list, by_x = {}, {}
  for _, case in ipairs(cases) do
    local at, value = rows.value(case, x), rows.value(case, y)
    if points.good(case) and at ~= nil and type(value) == "number" then
      if not by_x[at] then
        by_x[at] = {}
        list[#list + 1] = { at }
      end
      table.insert(by_x[at], value)
    end
  end
  for _, point in ipairs(list) do point[2] = points.median(by_x[point[1]]) end
  if #list > 0 and type(list[1][1]) == "number" then table.sort(list, function(a, b) return a[1] < b[1] end) end
  return list
end

-- Whether there are three or more numbers with equal ratios (to one in a million).
local function geometric(numbers)
  for k, x in ipairs(numbers) do
    if type(x) ~= "number" or x <= 0 then return false end
    if k > 2 and math.abs(x * numbers[k - 2] / numbers[k - 1] ^ 2 - 1) > 1e-6 then return false end
  end
  return #numbers > 2
end

local function distinct(values)
  local list, seen = {}, {}
  for _, value in ipairs(values) do
    if not seen[value] then list[#list + 1] = value end
    seen[value] = true
  end
  return list
end

-- ---- lines ----

-- Puts the tics at the values themselves where these are few.
local function tics(letter, values)
  local list = {}
  for k, value in ipairs(values) do
    list[k] = ("%s %s"):format(plot.quote(points.text(value)), type(value) == "number" and ("%.9g"):format(value) or k)
  end
  return ("set %stics (%s)"):format(letter, table.concat(list, ", "))
end

local function named(values)
  for _, value in ipairs(values) do
    if type(value) ~= "number" then return true end
  end
  return false
end

-- The range of an axis, with margins beside the first and the last value.
local function margins(numbers, log)
  local low, high = math.huge, -math.huge
  for _, x in ipairs(numbers) do low, high = math.min(low, x), math.max(high, x) end
  if low >= high then return nil end
  if log then
    local room = (high / low) ^ 0.04
    return low / room, high * room
  end
  return low - 0.04 * (high - low), high + 0.04 * (high - low)
end

local function horizontal(the, figure, x, curves)
  local values, scale = points.axis(the, x)
  local axis, commands = { label = figure.xlabel or rows.label(the, x) }, {}
  if values and named(values) then
    local place = {}
    for k, value in ipairs(values) do place[value] = k end
    for _, curve in ipairs(curves) do
      for _, point in ipairs(curve.points) do point[1] = place[point[1]] end
      curve.lines = false -- no lines are drawn between names
    end
    commands[1], axis.min, axis.max = tics("x", values), 0.5, #values + 0.5
    return axis, commands
  end
  local numbers = {}
  for _, curve in ipairs(curves) do
    for _, point in ipairs(curve.points) do numbers[#numbers + 1] = point[1] end
  end
  axis.log = figure.logx
  if axis.log == nil then axis.log = scale == "log" or geometric(values or {}) or points.wants_log(numbers) end
  numbers = distinct(numbers)
  axis.min, axis.max = margins(numbers, axis.log)
  if #numbers <= 8 and values then commands[1] = tics("x", numbers) end
  return axis, commands
end

local function vertical(the, figure, curves)
  local numbers = {}
  for _, curve in ipairs(curves) do
    for _, point in ipairs(curve.points) do numbers[#numbers + 1] = point[2] end
  end
  local axis = { label = figure.ylabel or rows.label(the, figure.measure), log = figure.logy, min = figure.min,
    max = figure.max, fixed = figure.min ~= nil or figure.max ~= nil }
  if axis.log == nil then axis.log = points.wants_log(numbers) end
  return axis, #numbers
end

local function curves_of(the, figure, cases, names)
  local x, curves = points.over(figure)[1], {}
  for _, group in ipairs(points.grouped(cases, names)) do
    local list = figure.along and points_along(group, x, figure.measure, figure) or
      points_of(group, x, figure.measure)
    if #list > 0 then
      local lines = figure.along ~= nil or not points.sampled(the, x)
      curves[#curves + 1] = { title = group.label, points = list, lines = lines }
    end
  end
  return curves
end

-- ---- panels ----

-- The curves of all panels: what is called the same looks the same in each. Gives the names in their order.
local function style_alike(panels)
  local names, number = {}, {}
  for _, panel in ipairs(panels) do
    for _, curve in ipairs(panel.curves) do
      if not number[curve.title] then
        names[#names + 1] = curve.title
        number[curve.title] = #names
      end
      curve.style = number[curve.title]
    end
  end
  return names
end

local function panel_items(panel, k, data)
  local items = {}
  for c, curve in ipairs(panel.curves) do
    local name = ("P%dC%d"):format(k, c)
    data[#data + 1] = { name = name, rows = curve.points }
    items[c] = ("$%s using 1:2 with %s ls %d notitle"):format(name, curve.lines and "linespoints" or "points", curve.style)
  end
  return #items > 0 and items or { "NaN notitle" }
end

-- One legend above all.
local function panel_commands(the, figure, all, names)
  local x, commands = points.over(figure)[1], {}
  local x_axis, more = horizontal(the, figure, x, all)
  local y_axis = vertical(the, figure, all)
  if not y_axis.fixed then y_axis.min, y_axis.max = margins(plot.column(all, 2), y_axis.log) end
  plot.axis("x", x_axis, commands, plot.column(all, 1))
  plot.axis("y", y_axis, commands, plot.column(all, 2))
  table.move(more, 1, #more, #commands + 1, commands)
  for k in ipairs(names) do commands[#commands + 1] = plot.style_line(k) end
  return commands
end

local function draw_panels(the, figure, path)
  local panels, all, data = points.grouped(the.cases, figure.panels), {}, {}
  local names = points.others(the, { points.over(figure)[1], figure.along, table.unpack(figure.panels) })
  for _, panel in ipairs(panels) do
    panel.curves = curves_of(the, figure, panel, names)
    table.move(panel.curves, 1, #panel.curves, #all + 1, all)
  end
  if #all == 0 then return nil, ("no picture %s.png: no case that ended well has '%s'"):format(path, figure.measure) end
  local titles, across = style_alike(panels), math.min(#panels, 2)
  local down = math.ceil(#panels / across)
  local commands, items = panel_commands(the, figure, all, titles), {}
  local heading, part = remarks.title(the, figure.title or figure.measure), 1 / down
  commands[#commands + 1] = ("set multiplot layout %d,%d margins 0.08,0.985,%.3g,%.3g spacing 0.09,%.3g "
    .. "title %s noenhanced offset 0,-0.5"):format(down, across, 0.16 * part, 1 - 0.26 * part, 0.26 * part, plot.quote(heading))
  commands[#commands + 1] = ("set key at screen 0.5,%.3g center top vertical maxrows 1 Left reverse samplen 4 width 2"):format(
    1 - 0.115 * part)
  for k, panel in ipairs(panels) do
    commands[#commands + 1] = ("set title %s noenhanced"):format(plot.quote(panel.label))
    items = panel_items(panel, k, data)
    if k < #panels then commands[#commands + 1] = "plot " .. table.concat(items, ", \\\n     ") end
  end
  for k, title in ipairs(titles) do
    if title ~= "" then items[#items + 1] = ("keyentry with linespoints ls %d title %s noenhanced"):format(k, plot.quote(title)) end
  end
  items[#items] = items[#items] .. "\nunset multiplot"
  return plot.draw(path, { commands = commands, more = items, data = data, width = figure.width or 560 * across + 40,
    height = figure.height or 400 * down + 60 })
end

-- ---- one diagram ----

local function draw_lines(the, figure, path)
  local x = points.over(figure)[1]
  local curves = curves_of(the, figure, the.cases, points.others(the, { x, figure.along }))
  local y_axis, count = vertical(the, figure, curves)
  if count == 0 then return nil, ("no picture %s.png: no case that ended well has '%s' and '%s'"):format(path,
    figure.measure, x) end
  local x_axis, commands = horizontal(the, figure, x, curves)
  if #curves == 1 and curves[1].title == "" then commands[#commands + 1] = "unset key" end
  local title = figure.title or ("%s: %s"):format(the.definition.name, figure.measure)
  return plot.draw(path, { title = remarks.title(the, title), x = x_axis, y = y_axis, curves = curves,
    commands = commands, width = figure.width, height = figure.height })
end

-- ---- one figure ----

local function file_part(text)
  return (text:gsub("[^%w_.-]+", "-"))
end

-- Draws a figure; returns the names of the pictures without the extension, or nil and the reason why there are none.
function figures.draw(the, results, figure, base)
  local over = figure.path and { "paths" } or points.over(figure)
  local path = ("%s-%s"):format(base, file_part(figure.name or figure.path and "paths" or
    figure.measure .. "-" .. table.concat(over, "-")))
  local fine, why
  if figure.path then fine, why = paths.draw(the, results, figure, path)
  elseif #over == 2 then fine, why = maps.draw(the, figure, path)
  elseif figure.panels then fine, why = draw_panels(the, figure, path)
  else fine, why = draw_lines(the, figure, path) end
  if not fine then return nil, why end
  return path .. (fine == true and "" or fine)
end

return figures
