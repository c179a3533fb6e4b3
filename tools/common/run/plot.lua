-- Diagrams through gnuplot: data and script are written beside the pictures (NAME.dat, NAME.gp), so that users can draw
-- them again, and NAME.png and NAME.svg are made of them. Curves differ by dash and by point type as well as by colour
-- (Okabe and Ito 2008), so they can be told apart in black and white; the legend stands outside.
--
--   plot.draw("out/bench/circle/bench", {
--     title = , x = { label = , log = true, min =, max = }, y = { ... },
--     curves = { { title =, points = { {x, y}, ... }, style = 3 (or nil: the next), lines = true, marks = true } },
--     commands = { "any gnuplot command before the plot" },
--     more = { "any further item of the plot command" },      -- such as '$GIVEN with filledcurves ...'
--     data = { { name =, rows = { {..}, ... } } },            -- further blocks of data, by name
--     width = 1200, height = 760,                             -- pixels of the PNG; higher where the legend needs it
--     matrix = { rows = { { x, y, z }, ... }, label = }       -- a heat map instead of curves
--   })
-- returns true; or nil and the reason why there is no picture (data and script are written in any case).
local files = require("common.run.file")

local plot = {}

local colours = { "#000000", "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7F7F7F" }
local points = { 7, 5, 9, 11, 13, 6, 4, 8, 10, 12, 2, 1, 3 } -- gnuplot's point types, filled ones first
local dashes = { "1", "(12,5)", "(4,4)", "(14,4,3,4)", "(14,4,3,4,3,4)", "(20,6)" }

-- A text in gnuplot's quotes, on one line; "_" and similar characters are printed as they are.
function plot.quote(text)
  return "'" .. text:gsub("%c", " "):gsub("'", "''") .. "'"
end

-- The same for words that are drawn: gnuplot does not read two apostrophes in a row (x''), so they are typographic ones.
function plot.words(text) return plot.quote((text:gsub("'", "\u{2019}"))) end

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

local function axis(letter, a, lines)
  if not a then return end
  if a.label then lines[#lines + 1] = ("set %slabel %s noenhanced"):format(letter, plot.quote(a.label)) end
  if a.log then
    lines[#lines + 1] = ("set logscale %s"):format(letter)
    lines[#lines + 1] = ("set format %s '10^{%%L}'"):format(letter)
  end
  if a.min or a.max then
    lines[#lines + 1] = ("set %srange [%s:%s]"):format(letter, a.min and number(a.min) or "*",
      a.max and number(a.max) or "*")
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

local function settings(figure, lines)
  if figure.title then lines[#lines + 1] = ("set title %s noenhanced"):format(plot.quote(figure.title)) end
  lines[#lines + 1] = "set key outside right top vertical maxcols 1 Left reverse samplen 4 spacing 1.1 width 1"
  lines[#lines + 1] = "set border lw 1.2"
  lines[#lines + 1] = "set tics nomirror scale 0.8"
  lines[#lines + 1] = "set grid xtics ytics lc rgb '#DDDDDD' lt 1 lw 0.6"
  axis("x", figure.x, lines)
  axis("y", figure.y, lines)
  for k = 1, #(figure.curves or {}) + 1 do lines[#lines + 1] = plot.style_line(k) end
  for _, curve in ipairs(figure.curves or {}) do
    if curve.style then lines[#lines + 1] = plot.style_line(curve.style) end
  end
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
  settings(figure, lines)
  if figure.matrix then items[1] = heat_map(figure, lines) end
  for _, command in ipairs(figure.commands or {}) do lines[#lines + 1] = command end
  for _, more in ipairs(figure.more or {}) do items[#items + 1] = more end
  for k, curve in ipairs(figure.curves or {}) do items[#items + 1] = item(curve, k) end
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
  local pipe = io.popen(("cd %s && exec gnuplot - >%s 2>&1"):format(shell(folder), shell(said)), "w")
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
      math.max(figure.height or 760, 100 + 22 * #(figure.curves or {}))) -- height for the legend
    script[#script + 1] = ("set output '%s.%s'"):format(name, terminal.ending)
    script[#script + 1] = ("load '%s.gp'"):format(name)
  end
  return plot.gnuplot(folder, table.concat(script, "\n"))
end

function plot.draw(path, figure)
  local folder, name = path:match("^(.*)/([^/]+)$")
  folder, name = folder or ".", name or path
  local fine, why = files.write(path .. ".dat", data_of(figure))
  if fine then fine, why = files.write(path .. ".gp", script_of(name, figure)) end
  if not fine then return nil, "the diagram: " .. why end
  local failed = render(folder, name, figure)
  if failed then return nil, ("no picture %s.png: %s; its script is %s.gp"):format(path, failed, path) end
  return true
end

return plot
