-- Heat maps of a sweep: a measure as colour over two parameters, one picture for each combination of the others.
local axes = require("common.run.axes")
local plan = require("common.sweep.plan")
local plot = require("common.run.plot")
local points = require("common.sweep.points")
local remarks = require("common.sweep.remarks")
local rows = require("common.sweep.table")

local maps = {}

-- Columns and rows are the parameters' values in order, so all cells have the same size for any spacing.
local function cells(cases, measure, x, y)
  local at, numbers = {}, {}
  for _, case in ipairs(cases) do
    local value = rows.value(case, measure)
    if points.good(case) and type(value) == "number" then
      local key = points.exact(case.values[x]) .. "\0" .. points.exact(case.values[y])
      at[key] = at[key] or {}
      table.insert(at[key], value)
      numbers[#numbers + 1] = value
    end
  end
  return at, numbers
end

local function matrix_of(at, xs, ys)
  local list = {}
  for j, y in ipairs(ys) do
    for i, x in ipairs(xs) do
      local values = at[points.exact(x) .. "\0" .. points.exact(y)]
      list[#list + 1] = { i, j, values and points.median(values) or 0 / 0 }
    end
  end
  return list
end

-- Tics with at most twelve labels.
local function cell_tics(letter, values)
  local list, every = {}, (#values + 11) // 12
  for k = 1, #values, every do list[#list + 1] = ("%s %d"):format(plot.quote(points.text(values[k])), k) end
  return ("set %stics (%s)"):format(letter, table.concat(list, ", "))
end

-- The lightness increases with the value and stays below white, which marks a cell without a result.
local colour_scale = "set palette defined (0 '#2A0A4A', 1 '#3B4F8B', 2 '#21908C', 3 '#5DC863', 4 '#FDE725')"

-- A logarithmic bar of colours, from the smallest positive number to the largest.
local function log_bar(numbers, commands)
  local low, high = axes.extent(numbers, true)
  commands[#commands + 1] = "set logscale cb"
  if not low or low == high then return end
  commands[#commands + 1] = ("set cbrange [%.9g:%.9g]"):format(low, high)
  commands[#commands + 1] = plot.log_ticks("cb", low, high)
end

local function draw_map(the, figure, group, path)
  local x, y = table.unpack(points.over(figure))
  local xs, ys = points.axis(the, x), points.axis(the, y)
  local at, numbers = cells(group, figure.measure, x, y)
  if #numbers == 0 then
    return nil, ("no picture %s.png: no case that ended well has '%s'"):format(path, figure.measure)
  end
  local title = figure.title or ("%s: %s"):format(the.definition.name, figure.measure)
  local commands = { cell_tics("x", xs), cell_tics("y", ys), "unset key", "set tics scale 0",
    "set autoscale noextend", "set rmargin at screen 0.84", "set format cb '%.6g'", colour_scale }
  local log = figure.logy
  if log == nil then log = points.wants_log(numbers) end
  if log then log_bar(numbers, commands) end
  return plot.draw(path, { title = remarks.title(the, group.label == "" and title or title .. ", " .. group.label),
    x = { label = figure.xlabel or rows.label(the, x), min = 0.5, max = #xs + 0.5 }, y = { label = figure.ylabel or rows.label(the, y),
    min = 0.5, max = #ys + 0.5 }, matrix = { rows = matrix_of(at, xs, ys), label = rows.label(the, figure.measure) }, commands = commands,
    width = figure.width, height = figure.height })
end

local function groups_of(the, figure)
  local names = points.others(the, points.over(figure))
  return points.grouped(the.cases, names), names
end

-- Refuses figures that cannot be drawn, before the first case runs.
function maps.check(the, figure)
  for _, name in ipairs(points.over(figure)) do
    if not points.axis(the, name) or points.sampled(the, name) then
      plan.refuse("a heat map of %s: '%s' is not a parameter with a list of values", figure.measure, name)
    end
  end
  local groups, names = groups_of(the, figure)
  if #groups > 12 then
    plan.refuse("a heat map of %s over %s would take %d pictures: sweep fewer values of %s", figure.measure,
      table.concat(points.over(figure), " and "), #groups, table.concat(names, ", "))
  end
end

function maps.draw(the, figure, path)
  local groups = groups_of(the, figure)
  for k, group in ipairs(groups) do
    local fine, why = draw_map(the, figure, group, #groups > 1 and path .. "-" .. k or path)
    if not fine then return nil, why end
  end
  return #groups > 1 and ("-1 to -%d"):format(#groups) or ""
end

return maps
