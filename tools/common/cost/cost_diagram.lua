-- The diagram of a study of costs (common/cost/cost.lua): for each part of the scene what of the run's time goes without it,
-- and how far from the whole run the run without it ends. What is far to the left and high up is worth its time.
local plot = require("common.run.plot")

local diagram = {}

-- Of data that came as JSON, where a number that is none is no number.
local function known(x) return type(x) == "number" and x == x end

-- The end without a part where nothing else is between the two: below all others, so that a logarithm can have it.
local function least_of(study)
  local least, most = math.huge, 0
  for _, part in ipairs(study.parts) do
    if known(part.x) and part.x > 0 then least, most = math.min(least, part.x), math.max(most, part.x) end
  end
  if most == 0 then return 1e-16, 1 end
  return least, most
end

local function saving(part)
  local figure = part.same or part.own
  if type(figure) == "table" and known(figure.saved) then return 100 * figure.saved, 100 * figure.spread end
end

-- A line across the diagram, with its meaning as text.
local function across(commands, y, text)
  commands[#commands + 1] = ("set arrow from graph 0, first %.9g to graph 1, first %.9g nohead dt 2 lc rgb '#7F7F7F'"):format(y, y)
  commands[#commands + 1] = ("set label %s at graph 0.01, first %.9g offset 0, 0.6 tc rgb '#555555'"):format(plot.text(text), y)
end

-- The curves of one point each, and the spreads of what they save; the parts that are not drawn.
local function points_of(study, floor)
  local curves, spreads, absent = {}, {}, {}
  for _, part in ipairs(study.parts) do
    local saved, spread = saving(part)
    if saved and known(part.x) then
      local y = math.max(part.x, floor)
      curves[#curves + 1] = { title = part.x > 0 and part.label or part.label .. " (ends where it did)", lines = false,
        points = { { saved, y } } }
      spreads[#spreads + 1] = { saved, y, 2 * spread }
    else
      absent[#absent + 1] = part.label
    end
  end
  return curves, spreads, absent
end

-- Writes PATH.png and .svg. nil and the reason where there is no picture; the labels of the parts that are not in it.
function diagram.draw(path, study)
  local least = least_of(study)
  local floor = least / 10
  local curves, spreads, absent = points_of(study, floor)
  if #curves == 0 then return nil, "no part of the scene has both a time and an end of its own" end
  local commands = { "set arrow from 0, graph 0 to 0, graph 1 nohead lc rgb '#7F7F7F'" }
  local chance = type(study.chance) == "table" and known(study.chance.x) and study.chance.x or 0
  if chance > floor then across(commands, chance, "what a disturbance of the start may change") end
  if known(study.accuracy) then across(commands, study.accuracy, "the accuracy asked") end
  local drawn, why = plot.draw(path, { title = ("%s: what its parts cost, and what they are worth"):format(study.whole.scene),
    x = { label = "time that the run takes less without it, %" }, curves = curves, commands = commands,
    y = { label = "how far elsewhere it then ends, m", log = true },
    data = { { name = "SPREAD", rows = spreads } },
    more = { "$SPREAD using 1:2:3 with xerrorbars lc rgb '#7F7F7F' pt 0 lw 1 notitle" } })
  return drawn and absent or nil, why
end

return diagram
