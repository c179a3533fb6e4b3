-- The numbers behind diagrams (tools/common/run/axes.lua), and that what gnuplot is given holds every point.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
package.path = ("%s/tools/?.lua;"):format(root) .. package.path
hooke = { create = function(path) return io.open(path, "wb") end } -- luacheck: globals hooke
local axes = require("common.run.axes")
local plot = require("common.run.plot")

local function same(what, list, wanted)
  for k = 1, math.max(#list, #wanted) do
    assert(list[k] and wanted[k] and math.abs(list[k] - wanted[k]) <= 1e-12 * math.abs(wanted[k]),
      ("%s: item %d is %s instead of %s"):format(what, k, list[k], wanted[k]))
  end
end

-- ---- ranges: a side that is given moves only where a point is beyond it, by 4 % more ----

same("nothing outside", { axes.range({ min = 0, max = 1.2 }, { 0.5, 1.1 }) }, { 0, 1.2, 0 })
same("one above", { axes.range({ min = 0, max = 1.2 }, { 0.5, 2 }) }, { 0, 2 + 0.04 * 2, 0 })
same("one below, logarithmic", { axes.range({ min = 1, max = 100, log = true }, { 0.01, 10 }) }, { 0.01 / 1e4 ^ 0.04, 100, 0 })
same("fixed", { axes.range({ min = 0, max = 1, fixed = true }, { -1, 0.5, 3, 0 / 0 }) }, { 0, 1, 2 })
assert(select("#", axes.range({}, {})) == 3)
assert(axes.extent({ -1, 0, 3, 1 / 0, 0 / 0 }, true) == 3) -- what has a logarithm, and is finite

-- ---- logarithmic ticks: never fewer than two, all inside ----

same("decades", axes.log_ticks(0.5, 2e3), { 1, 10, 100, 1000 })
same("multiples", axes.log_ticks(3, 60), { 5, 10, 20, 50 })
for k = 1, 2000 do
  local low = 10 ^ (8 * math.sin(k))
  local high = low * (1 + 10 ^ (4 * math.sin(3.7 * k) - 2))
  local ticks = axes.log_ticks(low, high)
  assert(#ticks >= 2, "fewer than two ticks")
  for _, x in ipairs(ticks) do assert(x > low * (1 - 1e-6) and x < high * (1 + 1e-6), "a tick outside") end
end

-- ---- a front: for any error allowed, the cheapest point that keeps it, and no cost between two points ----

local front = { { 1e-2, 1 }, { 1e-6, 30 }, { 1e-4, 5 } }
local steps = axes.staircase(front, 1, 100)
for k, wanted in ipairs { { 1e-6, 100 }, { 1e-6, 30 }, { 1e-4, 30 }, { 1e-4, 5 }, { 1e-2, 5 }, { 1e-2, 1 }, { 1, 1 } } do
  same("step " .. k, steps[k], wanted)
end
assert(#steps == 7 and #axes.staircase({}, 1, 1) == 0)

-- ---- names beside curves: a line apart, in order, about where they belong ----

same("apart already", axes.spread({ 0.9, 0.1 }, 0.04), { 0.9, 0.1 })
same("equal", axes.spread({ 0.5, 0.5, 0.5 }, 0.1), { 0.4, 0.5, 0.6 })
for trial = 1, 500 do
  local heights = {}
  for k = 1, 1 + trial % 7 do heights[k] = math.abs(math.sin(12.9898 * trial * k)) end
  local placed = axes.spread(heights, 0.05)
  for a in ipairs(heights) do
    for b in ipairs(heights) do
      assert(a == b or math.abs(placed[a] - placed[b]) > 0.05 - 1e-9, "two names in one place")
      assert(heights[a] >= heights[b] or placed[a] < placed[b], "names out of order")
    end
  end
end

-- ---- what gnuplot is given ----

local folder = os.tmpname()
os.remove(folder)
local function script(figure)
  plot.draw(folder, figure) -- without gnuplot the script is there all the same
  local file = assert(io.open(folder .. ".gp"))
  local text = file:read("a")
  file:close()
  return text
end
local curves = { { title = "rises", points = { { 1, 1 }, { 10, 1.5 } } }, { title = "falls", points = { { 1, 1 }, { 10, 1.49 } } } }
local text = script { title = "two", x = { log = true }, y = { min = 0, max = 1.2 }, curves = curves }
assert(text:find("set yrange [0:1.56]", 1, true), text) -- 1.5, and 4 % of what is between it and 0
assert(text:find("set xtics ('10^{0}' 1, '10^{1}' 10)", 1, true), text)
local first, second = text:match("'rises' at graph [%d.]+, first ([%d.]+).-'falls' at graph [%d.]+, first ([%d.]+)")
assert(first and first - second >= 0.04 * 1.56 - 1e-6 and text:find("unset key", 1, true), text)
-- A logarithmic axis ends 4 % beyond its data, not at the next powers of ten.
local wide = script { title = "wide", x = { log = true }, y = { log = true }, curves = { { points = { { 100, 20 }, { 1e6, 4e4 } } } } }
for axis, range in pairs { x = { 100 / 1e4 ^ 0.04, 1e6 * 1e4 ^ 0.04 }, y = { 20 / 2000 ^ 0.04, 4e4 * 2000 ^ 0.04 } } do
  assert(wide:find(("set %srange [%.9g:%.9g]"):format(axis, range[1], range[2]), 1, true), wide)
end
text = script { title = "fixed", y = { max = 1.2, fixed = true }, curves = curves }
assert(text:find("fixed (2 points outside)", 1, true), text)
text = script { title = "some have no logarithm", x = { log = true }, curves = { { points = { { 0, 1 }, { 1, 2 }, { 9, 3 } } } } }
assert(text:find("some have no logarithm (1 point outside)", 1, true), text)
local drawn, reason = plot.draw(folder, { x = { log = true, label = "limit" }, curves = { { points = { { 0, 1 } } } } })
assert(not drawn and reason:find("no number of 'limit' is above 0, and its axis is logarithmic", 1, true), reason)

-- Of twelve curves eight have names and colours, those that matter first, and four are one entry, grey, and drawn before them.
curves = {}
for k = 1, 12 do curves[k] = { title = "curve " .. k, points = { { 1, k }, { 2, k } }, main = k == 11 } end
text = script { title = "many", curves = curves }
for k = 1, 12 do assert((text:find("title 'curve " .. k .. "'", 1, true) ~= nil) == (k <= 7 or k == 11), text) end
assert(select(2, text:gsub(" ls 99 ", "")) == 4 and text:find("ls 99 title '4 others'", 1, true), text)
assert(text:find("'4 others'", 1, true) < text:find("'curve 1'", 1, true), text)
assert(select(2, text:gsub("with linespoints ls 99 ", "")) == 4, text) -- of which one may be a single point
for style = 1, 8 do assert(text:find((" ls %d title 'curve "):format(style), 1, true), text) end -- each of the eight colours once

-- ---- panels of validate: every error inside, also where they span less than a decade, and two ticks at least ----

local panels = require("common.validate.panels")
local panel = { title = "small span", label = "n", ticks = { { 0.5, "2" }, { 0.25, "4" } },
  curves = { { name = "e", order = "1", points = { { 0.5, 0.004 }, { 0.25, 0.002 }, { 0.1, 0.003 } } } } }
text = panels.script({ panel }, 1, 1, 1, "topic")
assert(text:find("set ytics ('0.002' 0.002", 1, true), text)
local from, to = text:match("set xrange %[([%d.e-]+):([%d.e-]+)%]")
assert(tonumber(from) < 0.1 and tonumber(to) >= 0.5 * 1.25 - 1e-9, text) -- a level that is no tick is inside as well

for _, ending in ipairs { ".gp", ".dat", ".png", ".svg" } do os.remove(folder .. ending) end
print("passed")
