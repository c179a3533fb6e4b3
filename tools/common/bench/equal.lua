-- Settings of a bench that were equal in effect: two methods, or the same with two values of --vary, whose runs have the same
-- errors and evaluations to the last bit wherever both had the same step or tolerance; and tolerances of one method between which
-- its steps did not change. Of a motion without errors nothing is said.
local methods = require("common.bench.methods")

local equal = {}

local function ended_well(row) return row.errors and (row.verdict == "ok" or row.verdict == "inaccurate") end

-- All that two runs with the same effect have in common; nil: not known, or without an error that could tell them apart.
local function effect_of(row)
  if not ended_well(row) then return nil end
  local e, told = row.errors, false
  local parts = { ("%d"):format(row.result.steps), ("%d"):format(row.result.force_evaluations) }
  local function add(name, value)
    told = told or value ~= 0 and value == value
    parts[#parts + 1] = ("%s %.17g"):format(name, value or 0 / 0)
  end
  for _, name in ipairs { "x_rms", "x_max", "v_rms", "v_max" } do add(name, e[name]) end
  local names = {}
  for name in pairs(e.measure) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do add(name, e.measure[name]) end
  return told and table.concat(parts, "\0") or nil
end

local function by_setting(method)
  local found = {}
  for _, row in ipairs(method.rows) do
    if ended_well(row) then found[methods.setting_text(row.setting)] = effect_of(row) or false end
  end
  return found
end

local function agree(a, b)
  local common = false
  for setting, effect in pairs(a) do
    local other = b[setting]
    if other ~= nil and (not effect or effect ~= other) then return false end
    common = common or other ~= nil
  end
  return common
end

-- { { label, label, ... } }: methods with the same effect.
function equal.methods(list)
  local groups = {}
  for _, method in ipairs(list) do
    local rows, into = by_setting(method), nil
    for _, group in ipairs(groups) do
      if not into and agree(group.rows, rows) then into = group end
    end
    if not into then
      into = { rows = rows, labels = {} }
      groups[#groups + 1] = into
    end
    table.insert(into.labels, method.label)
  end
  local found = {}
  for _, group in ipairs(groups) do
    if #group.labels > 1 then found[#found + 1] = group.labels end
  end
  return found
end

-- { { label =, settings = { text, text, ... } } }: settings of one method, next to each other, with the same effect.
function equal.settings(list)
  local found = {}
  for _, method in ipairs(list) do
    local last, group
    for _, row in ipairs(method.rows) do
      local effect, text = effect_of(row), methods.setting_text(row.setting)
      if effect and effect == last then
        if #group.settings == 1 then found[#found + 1] = group end
        table.insert(group.settings, text)
      else
        group = { label = method.label, settings = { text } }
      end
      last = effect
    end
  end
  return found
end

return equal
