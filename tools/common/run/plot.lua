-- Diagrams through gnuplot: data and script are written beside the pictures (NAME.dat, NAME.gp), so that users can draw
-- them again, and NAME.png and NAME.svg are made of them. Curves differ by dash and by point type as well as by colour
-- (Okabe and Ito 2008), so they can be told apart in black and white; the legend stands outside.
--
--   plot.draw("out/bench/circle/bench", {
--     title = , x = { label = , log = true, min =, max = }, y = { ... },
--     curves = { { title =, points = { {x, y}, ... }, style = 3 (or nil: the next), lines = true, marks = true,
--       main = true } },                                      -- of more than eight, eight have names: these first
--     commands = { "any gnuplot command before the plot" },
--     more = { "any further item of the plot command" },      -- such as '$GIVEN with filledcurves ...'
--     data = { { name =, rows = { {..}, ... } } },            -- further blocks of data, by name
--     width = 1200, height = 760,                             -- pixels of the PNG; higher where the legend needs it
--     matrix = { rows = { { x, y, z }, ... }, label = }       -- a heat map instead of curves
--   })
-- returns true; or nil and the reason why there is no picture (data and script are written in any case).
--
-- Ranges are widened where a point would be outside (`fixed = true` of an axis: not so, and the title says how many are).
-- Up to eight curves that reach the right side have their names there instead of a legend. Of more than eight curves eight
-- have colours and names, as many as can be told apart, and the rest is grey behind them.
local axes = require("common.run.axes")
local files = require("common.run.file")

local plot = {}

local colours = { "#000000", "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7F7F7F" }
local points = { 7, 5, 9, 11, 13, 6, 4, 8, 10, 12, 2, 1, 3 } -- gnuplot's point types, filled ones first
local dashes = { "1", "(12,5)", "(4,4)", "(14,4,3,4)", "(14,4,3,4,3,4)", "(20,6)" }

-- A text in gnuplot's quotes, on one line; "_" and similar characters are printed as they are.
function plot.quote(text)
  return "'" .. text:gsub("%c", " "):gsub("'", "''") .. "'"
end

-- The same for text that is drawn: gnuplot does not read two apostrophes in a row (x''), so they become typographic ones.
function plot.text(text) return plot.quote((text:gsub("'", "\u{2019}"))) end

function plot.style_line(k)
  local colour, point, dash = (k - 1) % #colours + 1, (k - 1) % #points + 1, (k - 1 + (k - 1) // #colours) % #dashes + 1
  return ("set style line %d lc rgb '%s' pt %d ps 1.1 lw 1.8 dt %s"):format(k, colours[colour], points[point],
    dashes[dash])
end

local function number(x)
  return x and x == x and math.abs(x) < math.huge and ("%.9g"):format(x) or "NaN"
end

function plot.block(name, rows)
  local lines = { "$" .. name .. " << EOD" }
  for _, row in ipairs(rows) do
    local cells = {}
    for k = 1, #row do cells[k] = type(row[k]) == "string" and '"' .. row[k] .. '"' or number(row[k]) end
    lines[#lines + 1] = table.concat(cells, " ")
  end
  lines[#lines + 1] = "EOD"
  return table.concat(lines, "\n")
end

-- Powers of ten as such where all ticks are, otherwise plain numbers.
local function tick_text(x, powers)
  if powers then return ("'10^{%d}' %.9g"):format(math.floor(math.log(x, 10) + 0.5), x) end
  return ("'%.3g' %.9g"):format(x, x)
end

-- gnuplot's ticks of a logarithmic axis or colour bar ("cb"), where powers of ten alone would be fewer than two.
function plot.log_ticks(letter, low, high)
  local list, parts, powers = axes.log_ticks(low, high), {}, true
  for _, x in ipairs(list) do powers = powers and math.abs(math.log(x, 10) % 1 - 0.5) > 0.5 - 1e-9 end
  for k, x in ipairs(list) do parts[k] = tick_text(x, powers) end
  return ("set %stics (%s)"):format(letter, table.concat(parts, ", "))
end

-- Number k of all points of the curves.
function plot.column(curves, k)
  local values = {}
  for _, curve in ipairs(curves or {}) do
    for _, point in ipairs(curve.points) do values[#values + 1] = point[k] end
  end
  return values
end

-- Ticks and range of a logarithmic axis: gnuplot's own range would go on to the next powers of ten, up to an empty decade.
local function fit_logarithmic(letter, a, lines, values)
  local low, high = axes.extent(values, true)
  if not low then return end
  low, high = a.min or low, a.max or high
  if high <= low then return end
  local few = high / low < 100
  if few then lines[#lines + 1] = plot.log_ticks(letter, low, high) end
  local room = (high / low) ^ (few and 0.06 or 0.04)
  a.min, a.max = a.min or low / room, a.max or high * room
end

-- Appends gnuplot's commands for an axis ("x", "y") whose points have these values; a.outside: how many are beyond a
-- range that is fixed.
function plot.axis(letter, a, lines, values)
  if not a then return end
  a.min, a.max, a.outside = axes.range(a, values)
  if a.log then a.outside = a.outside + axes.without_logarithm(values) end
  if a.label then lines[#lines + 1] = ("set %slabel %s noenhanced"):format(letter, plot.quote(a.label)) end
  if a.log then
    lines[#lines + 1] = ("set logscale %s"):format(letter)
    lines[#lines + 1] = ("set format %s '10^{%%L}'"):format(letter)
    fit_logarithmic(letter, a, lines, values)
  end
  if a.min or a.max then
    lines[#lines + 1] = ("set %srange [%s:%s]"):format(letter, a.min and number(a.min) or "*",
      a.max and number(a.max) or "*")
  end
end

local most_coloured, grey = 8, 99 -- a style of its own

-- Of too many curves: all but eight become grey, and one of these says how many they are.
local function grey_out(figure)
  local left, rest, named = most_coloured, {}, 0
  if #(figure.curves or {}) <= most_coloured then return end
  for pass = 1, 2 do
    for _, curve in ipairs(figure.curves) do
      if (pass == 1) == (curve.main or false) then
        curve.named = left > 0
        left = left - 1
      end
    end
  end
  for _, curve in ipairs(figure.curves) do
    if not curve.named then
      rest[#rest + 1] = curve
    else
      named = named + 1
      curve.style = curve.style or named -- all eight colours
    end
  end
  for k, curve in ipairs(rest) do
    curve.style, curve.marks, curve.title = grey, true, k == 1 and ("%d others"):format(#rest) or ""
  end
end

local function item(curve, k)
  local with = curve.marks == false and "lines" or curve.lines == false and "points" or "linespoints"
  return ("$CURVE%d using 1:2 with %s ls %d title %s noenhanced"):format(k, with, curve.style or k,
    plot.quote(curve.title or ""))
end

local function data_of(figure)
  local parts = {}
  for k, curve in ipairs(figure.curves or {}) do parts[#parts + 1] = plot.block("CURVE" .. k, curve.points) end
  for _, more in ipairs(figure.data or {}) do parts[#parts + 1] = plot.block(more.name, more.rows) end
  if figure.matrix then parts[#parts + 1] = plot.block("MATRIX", figure.matrix.rows) end
  return table.concat(parts, "\n") .. "\n"
end

-- ---- names beside curves ----

local most_named, line_height = 8, 0.04 -- of the diagram's height

-- From numbers on an axis to 0 to 1, and back.
local function scale_of(a, values)
  local low, high = axes.extent(values, a and a.log)
  low, high = a and a.min or low or 0, a and a.max or high or 1
  if high <= low then high = low + 1 end
  if a and a.log then
    return function(x) return math.log(x / low) / math.log(high / low) end,
      function(share) return low * (high / low) ^ share end
  end
  return function(x) return (x - low) / (high - low) end, function(share) return low + share * (high - low) end
end

-- The heights of the curves' right ends; nil: they are too many, or end elsewhere.
local function ends(figure, across, up)
  local heights = {}
  for k, curve in ipairs(figure.curves) do
    local last
    for _, p in ipairs(curve.points) do
      if p[2] == p[2] and (not last or p[1] >= last[1]) then last = p end
    end
    if not last or curve.lines == false or not curve.title or curve.title == "" then return nil end
    if across(last[1]) < 0.9 then return nil end
    heights[k] = up(last[2])
    if heights[k] < 0 or heights[k] > 1 then return nil end
  end
  return heights
end

-- Whether curves are named at their ends; gives up the legend for it.
local function name_curves(figure, lines)
  local few = #(figure.curves or {}) >= 2 and #figure.curves <= most_named
  if not few or figure.more then return end
  local up, back = scale_of(figure.y, plot.column(figure.curves, 2))
  local heights = ends(figure, (scale_of(figure.x, plot.column(figure.curves, 1))), up)
  if not heights then return end
  local longest = 0
  for k, y in ipairs(axes.spread(heights, line_height)) do
    local title = figure.curves[k].title
    longest = math.max(longest, utf8.len(title) or #title)
    lines[#lines + 1] = ("set label %s at graph 1.015, first %.9g left noenhanced tc ls %d"):format(plot.quote(title), back(y),
      figure.curves[k].style or k)
  end
  lines[#lines + 1] = "unset key"
  lines[#lines + 1] = ("set rmargin %d"):format(longest + 4)
end

-- The title of a diagram with these axes, which says what is not seen.
function plot.title(title, x, y)
  local outside = (x and x.outside or 0) + (y and y.outside or 0)
  return outside == 0 and title or ("%s (%d point%s outside)"):format(title, outside, outside == 1 and "" or "s")
end

local function settings(figure, lines)
  lines[#lines + 1] = "set key outside right top vertical maxcols 1 Left reverse samplen 4 spacing 1.1 width 1"
  lines[#lines + 1] = "set border lw 1.2"
  lines[#lines + 1] = "set tics nomirror scale 0.8"
  lines[#lines + 1] = "set grid xtics ytics lc rgb '#DDDDDD' lt 1 lw 0.6"
  plot.axis("x", figure.x, lines, plot.column(figure.curves, 1))
  plot.axis("y", figure.y, lines, plot.column(figure.curves, 2))
  if figure.title then lines[#lines + 1] = ("set title %s noenhanced"):format(plot.quote(plot.title(figure.title, figure.x, figure.y))) end
  for k = 1, #(figure.curves or {}) + 1 do lines[#lines + 1] = plot.style_line(k) end
  for _, curve in ipairs(figure.curves or {}) do
    if curve.style and curve.style ~= grey then lines[#lines + 1] = plot.style_line(curve.style) end
  end
  lines[#lines + 1] = ("set style line %d lc rgb '#CCCCCC' pt 7 ps 0.6 lw 1 dt 1"):format(grey)
  name_curves(figure, lines)
end

local function heat_map(figure, lines)
  lines[#lines + 1] = "unset grid"
  lines[#lines + 1] = "set palette cubehelix start 0.5 cycles -1 saturation 1" -- its lightness increases uniformly
  if figure.matrix.label then
    lines[#lines + 1] = ("set cblabel %s noenhanced"):format(plot.quote(figure.matrix.label))
  end
  return "$MATRIX using 1:2:3 with image notitle"
end

local function script_of(name, figure)
  local lines, items = { ("load '%s.dat'"):format(name) }, {}
  grey_out(figure)
  settings(figure, lines)
  if figure.matrix then items[1] = heat_map(figure, lines) end
  for _, command in ipairs(figure.commands or {}) do lines[#lines + 1] = command end
  for _, more in ipairs(figure.more or {}) do items[#items + 1] = more end
  for behind = 1, 0, -1 do
    for k, curve in ipairs(figure.curves or {}) do
      if (curve.style == grey) == (behind == 1) then items[#items + 1] = item(curve, k) end
    end
  end
  lines[#lines + 1] = "plot " .. table.concat(items, ", \\\n     ")
  return table.concat(lines, "\n") .. "\n"
end

local terminals = {
  { ending = "png", text = "set terminal pngcairo size %d,%d font 'Sans,12' background rgb 'white'" },
  { ending = "svg", text = "set terminal svg size %d,%d font 'Sans,12' background rgb 'white'" },
}

local function shell(text) return "'" .. text:gsub("'", "'\\''") .. "'" end

-- Runs gnuplot in a folder; returns its error message, or nil on success.
function plot.gnuplot(folder, script)
  local said = os.tmpname()
  local pipe = io.popen(("cd %s && exec gnuplot -d - >%s 2>&1"):format(shell(folder), shell(said)), "w")
  pipe:write(script, "\nset output\n")
  local fine, _, code = pipe:close()
  local file = io.open(said)
  local text = file and file:read("a"):gsub("%s+", " ") or ""
  if file then file:close() end
  os.remove(said)
  if fine then return nil end
  if code == 127 then return "gnuplot is not installed (Debian: apt-get install gnuplot-nox)" end
  return ("gnuplot failed: %s"):format(text ~= "" and text or ("without a word, exit code %d"):format(code))
end

local function render(folder, name, figure)
  local script = {}
  for _, terminal in ipairs(terminals) do
    script[#script + 1] = terminal.text:format(figure.width or 1200,
      math.max(figure.height or 760, 140 + 24 * (#(figure.curves or {}) + #(figure.more or {})))) -- room for the legend
    script[#script + 1] = ("set output '%s.%s'"):format(name, terminal.ending)
    script[#script + 1] = ("load '%s.gp'"):format(name)
  end
  return plot.gnuplot(folder, table.concat(script, "\n"))
end

-- What no diagram can show: curves whose numbers on a logarithmic axis are all 0 or less.
local function nothing_to_see(figure)
  for k, a in ipairs { figure.x or {}, figure.y or {} } do
    local values = plot.column(figure.curves, k)
    if a.log and #values > 0 and not axes.extent(values, true) then
      return ("no number of '%s' is above 0, and its axis is logarithmic"):format(a.label or "")
    end
  end
end

function plot.draw(path, figure)
  local folder, name = path:match("^(.*)/([^/]+)$")
  folder, name = folder or ".", name or path
  local fine, why = files.write(path .. ".dat", data_of(figure))
  if fine then fine, why = files.write(path .. ".gp", script_of(name, figure)) end
  if not fine then return nil, "the diagram: " .. why end
  local failed = nothing_to_see(figure) or render(folder, name, figure)
  if failed then return nil, ("no picture %s.png: %s; its script is %s.gp"):format(path, failed, path) end
  return true
end

return plot
