-- The numbers of a run over time as the page's charts show them: which stand in one chart, and how they are called.
local json_text = require("common.view.json_text")

local series = {}

-- name -> { group, unit, name in the group }, in the order of the charts.
local known = {
  { "kinetic", "Energy", "J", "kinetic" }, { "potential", "Energy", "J", "potential" },
  { "energy", "Energy", "J", "total" }, { "work", "Energy", "J", "work" },
  { "momentum x", "Momentum", "kg m/s", "x" }, { "momentum y", "Momentum", "kg m/s", "y" },
  { "momentum z", "Momentum", "kg m/s", "z" },
  { "angular momentum x", "Angular momentum", "kg m²/s", "x" }, { "angular momentum y", "Angular momentum", "kg m²/s", "y" },
  { "angular momentum z", "Angular momentum", "kg m²/s", "z" },
  { "step", "Step length", "s", "step" },
  { "error", "Estimated error of a step, of the tolerance", "", "error" },
}

local function some_finite(values)
  for _, v in ipairs(values) do
    if v - v == 0 then return true end
  end
  return false
end

local function entry(group, unit, name, values)
  return { group = group, unit = unit, name = name, values = json_text.list(values) }
end

-- At the start there was no step yet.
local function steps_taken(values)
  local list = table.move(values, 1, #values, 1, {})
  if list[1] == 0 then list[1] = 0 / 0 end
  return list
end

-- all: { name = values }; units: those of measures, { name = unit }.
function series.of(all, units)
  local list, used = json_text.list(), {}
  for _, row in ipairs(known) do
    local name, values = row[1], all[row[1]]
    used[name] = true
    if name == "step" and values then values = steps_taken(values) end
    if values and some_finite(values) then list[#list + 1] = entry(row[2], row[3], row[4], values) end
  end
  local rest = {}
  for name in pairs(all) do
    if not used[name] then rest[#rest + 1] = name end
  end
  table.sort(rest)
  for _, name in ipairs(rest) do
    if some_finite(all[name]) then list[#list + 1] = entry(name, units[name] or "", name, all[name]) end
  end
  return list
end

return series
