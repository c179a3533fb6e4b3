-- The paths of a particle in a sweep's cases, side by side in panels: one gnuplot multiplot.
local plan = require("common.sweep.plan")
local plot = require("common.run.plot")
local points = require("common.sweep.points")

local paths = {}

local column = { x = 2, y = 3, z = 4 }
local colours = { "#D55E00", "#0072B2", "#009E73", "#000000", "#CC79A7", "#E69F00", "#56B4E9" }
local marks = { 7, 5, 9, 11, 13, 6, 4 }

local functions = {}
for word in ("t pi sin cos tan exp log sqrt abs sinh cosh tanh"):gmatch("%a+") do functions[word] = true end

-- Formulas of t are passed to gnuplot, so only arithmetic is allowed.
local function check_formula(text)
  if type(text) ~= "string" or text:find("[^%w%s+*/()^:.-]") then
    plan.refuse("plots: curves: '%s' is not a formula of t", tostring(text))
  end
  for word in text:gsub("%d+%.?%d*[eE][+-]?%d+", ""):gmatch("%a%w*") do
    if not functions[word] then plan.refuse("plots: curves: '%s': there is no function '%s' here", text, word) end
  end
end

-- Refuses figures that cannot be drawn, before the first case runs.
function paths.check(the, figure)
  if not the.definition.paths then
    plan.refuse("plots: path: paths = { %s } keeps the path of particle %s", figure.path, figure.path)
  end
  if type(figure.panels) ~= "table" or #figure.panels == 0 then
    plan.refuse("plots: path: panels = { the parameters whose values are drawn side by side } is missing")
  end
  for _, name in ipairs(figure.panels) do
    if not points.axis(the, name) then plan.refuse("plots: panels: '%s' is not swept", tostring(name)) end
  end
  for _, letter in ipairs(figure.axes or {}) do
    if not column[letter] then plan.refuse("plots: axes: '%s' is neither x, y nor z", tostring(letter)) end
  end
  for _, curve in pairs(figure.curves or {}) do
    check_formula(curve[1])
    check_formula(curve[2])
  end
end

local style = "$%s using %d:%d with linespoints pt %d ps %.2g lw %.2g dt %d lc rgb '%s' title %s noenhanced"

local function panel_items(the, results, figure, panel, blocks)
  local names, items = points.others(the, figure.panels), {}
  local curve = figure.curves and figure.curves[panel[1].values[figure.panels[1]]]
  if curve then
    items[1] = ("sample [t=%s] '+' using %s with lines lw 5 lc rgb '#CCCCCC' title 'exact'"):format(curve[1], curve[2])
  end
  local a, b = table.unpack(figure.axes or { "x", "y" })
  for k, case in ipairs(panel) do
    local places = {}
    for _, p in ipairs(case.row and results:path_of(case, figure.path) or {}) do
      places[#places + 1] = { p.t, p.x, p.y, p.z }
    end
    if #places > 0 then
      local name = ("PATH%d"):format(#blocks + 1)
      local size = 0.5 + 0.8 * (#panel - k) / #panel -- a path below another one remains visible at its edges
      blocks[#blocks + 1] = { name = name, rows = places }
      items[#items + 1] = style:format(name, column[a], column[b], marks[(k - 1) % #marks + 1], size, 1.8 * size,
        (k - 1) % 5 + 1, colours[(k - 1) % #colours + 1], plot.quote(points.label(case, names)))
    end
  end
  return items
end

-- `blocks`: of this panel. A range that the figure fixes may leave points outside: the title says how many.
local function panel_commands(figure, panel, blocks)
  local range = figure.range and figure.range[panel[1].values[figure.panels[1]]] or {}
  local letters, commands, axes = figure.axes or { "x", "y" }, { "set size ratio -1; set xrange [*:*]; set yrange [*:*]" }, {}
  for k, letter in ipairs { "x", "y" } do
    local values = {}
    for _, block in ipairs(blocks) do
      for _, row in ipairs(block.rows) do values[#values + 1] = row[column[letters[k]]] end
    end
    axes[k] = { min = range[2 * k - 1], max = range[2 * k], fixed = #range > 0 }
    plot.axis(letter, axes[k], commands, values)
  end
  table.insert(commands, ("set title %s noenhanced"):format(plot.quote(plot.title(panel.label, axes[1], axes[2]))))
  return commands
end

-- Orders panels by the first of the axes, then by the second, ..., independent of the order of the cases.
local function ordered(the, panels, names)
  for _, panel in ipairs(panels) do
    panel.place = 0
    for _, name in ipairs(names) do
      local values = points.axis(the, name)
      for k, value in ipairs(values) do
        if value == panel[1].values[name] then panel.place = panel.place * #values + k - 1 break end
      end
    end
  end
  table.sort(panels, function(a, b) return a.place < b.place end)
  return panels
end

-- Panels side by side: the first axis of `panels` downwards, the others across; one legend above all panels.
function paths.draw(the, results, figure, path)
  local panels = ordered(the, points.grouped(the.cases, figure.panels), figure.panels)
  local down = #points.axis(the, figure.panels[1])
  local across = math.ceil(#panels / down)
  local a, b = table.unpack(figure.axes or { "x", "y" })
  local commands = {
    ("set multiplot layout %d,%d margins 0.055,0.985,0.07,0.85 spacing 0.05,0.1 title %s noenhanced offset 0,-0.5")
      :format(down, across, plot.quote(points.title(the, figure.title or the.definition.name))),
    ("set xlabel %s; set ylabel %s; unset key"):format(plot.quote(figure.xlabel or a .. ", m"),
      plot.quote(figure.ylabel or b .. ", m")),
    "set key at screen 0.5,0.945 center top vertical maxrows 1 Left reverse samplen 4 width 2",
  }
  local blocks, more = {}, nil
  for k, panel in ipairs(panels) do
    local first = #blocks + 1
    local items = panel_items(the, results, figure, panel, blocks)
    if #items == 0 then items[1] = "NaN notitle" end
    local own = table.move(blocks, first, #blocks, 1, {})
    for _, command in ipairs(panel_commands(figure, panel, own)) do commands[#commands + 1] = command end
    if k == #panels then more = items
    else commands[#commands + 1] = "plot " .. table.concat(items, ", \\\n     ") .. "\nunset key" end
  end
  more[#more] = more[#more] .. "\nunset multiplot"
  return plot.draw(path, { commands = commands, more = more, data = blocks, width = figure.width or 360 * across + 60,
    height = figure.height or 360 * down + 80 })
end

return paths
