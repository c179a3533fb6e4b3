-- The numbers of a run over time as the page's charts show them: which stand in one chart, and how they are called.
local json_text = require("common.view.json_text")

local series = {}

-- name -> { group, unit, name in the group }, in the order of the charts.
local known = {
  { "kinetic", "Energy", "J", "kinetic" }, { "potential", "Energy", "J", "potential" },
  { "total", "Energy", "J", "total" }, { "work", "Energy", "J", "work" },
  { "momentum_x", "Momentum", "kg m/s", "x" }, { "momentum_y", "Momentum", "kg m/s", "y" },
  { "momentum_z", "Momentum", "kg m/s", "z" },
  { "angular_momentum_x", "Angular momentum", "kg m²/s", "x" }, { "angular_momentum_y", "Angular momentum", "kg m²/s", "y" },
  { "angular_momentum_z", "Angular momentum", "kg m²/s", "z" },
  { "strain", "Largest strain", "", "strain" }, { "step", "Step length", "s", "step" },
  { "error", "Estimated error of a step", "", "error" },
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

-- The total energy without the work that was done from outside, which should stay the same.
local function total_of(all)
  if not (all.kinetic and all.potential) or all.total then return nil end
  local sum = {}
  for k, kinetic in ipairs(all.kinetic) do
    sum[k] = kinetic + all.potential[k]
  end
  return sum
end

function series.of(all)
  local list, used, given = json_text.list(), {}, setmetatable({ total = total_of(all) }, { __index = all })
  for _, row in ipairs(known) do
    local name, values = row[1], given[row[1]]
    used[name] = true
    if values and some_finite(values) then list[#list + 1] = entry(row[2], row[3], row[4], values) end
  end
  local rest = {}
  for name in pairs(all) do
    if not used[name] then rest[#rest + 1] = name end
  end
  table.sort(rest)
  for _, name in ipairs(rest) do
    if some_finite(all[name]) then list[#list + 1] = entry(name, "", name, all[name]) end
  end
  return list
end

return series
