-- Pictures of the regions of stability that methods state.
local amplification = require("amplification")
local plot = require("common.run.plot")

local region_picture = {}

-- Of z = h lambda in the complex plane; the lower half mirrors the upper one. On both half-axes the root and its double
-- are taken: a method with one evaluation of the damping may have a smaller limit when the two roots differ (see the
-- table).
local grid = { low = -6, high = 2, top = 6, count = 160 }

local function panel(stated)
  local rows = {}
  for i = 0, grid.count do
    for j = 0, grid.count do
      local re, im = grid.low + (grid.high - grid.low) * i / grid.count, grid.top * j / grid.count
      rows[#rows + 1] = { re, im, stated(math.sqrt(re * re + im * im), -2 * re) <= 1 + 1e-7 and 1 or 0 }
    end
  end
  return rows
end

local function title_of(plugin)
  return ("%s, order %d"):format(plugin.name, plugin.order)
end

-- Draws the regions of all plugins that state their growth as NAME.png and NAME.svg; returns true, or nil and the
-- reason.
function region_picture.draw(path, plugins)
  local data, panels = {}, {}
  for _, plugin in ipairs(plugins) do
    local stated = amplification.open(plugin.path)
    if stated then
      local name = "P" .. #panels + 1
      data[#data + 1] = { name = name, rows = panel(stated) }
      panels[#panels + 1] = ("set title %s noenhanced offset 0,-0.7\n"):format(plot.quote(title_of(plugin)))
        .. ("plot $%s using 1:2:3 with image notitle"):format(name)
    end
  end
  if #panels == 0 then return nil, "no method states its growth" end
  local columns = math.min(6, #panels)
  local last = table.remove(panels)
  local head, item = last:match("^(.-)\nplot (.*)$")
  return plot.draw(path, { width = 260 * columns, height = 240 * math.ceil((#panels + 1) / columns) + 60,
    data = data, more = { item .. "\nunset multiplot" }, commands = { "unset key", "unset colorbox", "unset grid",
      "set palette defined (0 '#FFFFFF', 1 '#8FB3D9')", "set cbrange [0:1]",
      ("set xrange [%g:%g]"):format(grid.low, grid.high), ("set yrange [0:%g]"):format(grid.top), "set size ratio -1",
      "set xtics 2", "set ytics 2", "set arrow from 0,0 to 0,6 nohead front lc rgb '#000000' lw 0.6 dt 3",
      "set xlabel 'Re h {/Symbol l}' offset 0,0.6", "set ylabel 'Im h {/Symbol l}' offset 1.2,0",
      ("set multiplot layout %d,%d title 'Stable (filled): growth of a step at most 1'"):format(
        math.ceil((#panels + 1) / columns), columns), table.concat(panels, "\n"), head } })
end

return region_picture
