-- What a sweep's runs were warned of, and which of its settings were equal in effect: of cases that end with the same positions
-- and velocities, steps and measures, all to the last bit, the settings that differ have done nothing. A line of a diagram is
-- then flat because nothing changed, as where each --dt is above a frame and is cut to it.
local points = require("common.sweep.points")

local remarks = {}

-- Warnings that differ in their numbers alone are one kind.
local function kind_of(text) return (text:gsub("%-?%d[%d.]*[eE]?[+-]?%d*", "#")) end

local function numbers_of(cases)
  local list = {}
  for k, case in ipairs(cases) do list[k] = case.number end
  return (#list > 1 and "cases " or "case ") .. table.concat(list, ", ", 1, math.min(#list, 8))
    .. (#list > 8 and (" and %d more"):format(#list - 8) or "")
end

-- A line for each kind of warning: its cases, and what the first of them was told.
function remarks.warnings(the)
  local kinds, by_kind = {}, {}
  for _, case in ipairs(the.cases) do
    local said = {}
    for _, text in ipairs(case.result and case.result.warnings or {}) do
      local key = kind_of(text)
      if not by_kind[key] then
        by_kind[key] = { text = text, cases = {} }
        kinds[#kinds + 1] = by_kind[key]
      end
      if not said[key] then table.insert(by_kind[key].cases, case) end
      said[key] = true
    end
  end
  local lines = {}
  for k, kind in ipairs(kinds) do
    lines[k] = ("warning, %s: %s%s"):format(numbers_of(kind.cases), #kind.cases > 1 and "the first was told: " or "", kind.text)
  end
  return lines
end

-- All that two runs with the same effect have in common.
local function effect_of(case)
  local result, parts = case.result, {}
  for name, value in pairs(result.measures) do parts[#parts + 1] = name .. "=" .. points.exact(value) end
  table.sort(parts)
  for _, name in ipairs { "t", "steps", "force_evaluations" } do parts[#parts + 1] = points.exact(result[name]) end
  return result.state .. "\0" .. table.concat(parts, "\0")
end

local function axes_of(the)
  local names = {}
  for _, axis in ipairs(the.axes) do
    if axis.name ~= "repeat" and #axis.values > 1 then names[#names + 1] = axis.name end
  end
  return names
end

-- The settings in which the cases differ, each case's as a text; one case of each.
local function apart(cases, names)
  local differing, first = {}, cases[1]
  for _, name in ipairs(names) do
    for _, case in ipairs(cases) do
      if points.exact(case.values[name]) ~= points.exact(first.values[name]) then
        differing[#differing + 1] = name
        break
      end
    end
  end
  local list = {}
  for k, group in ipairs(points.grouped(cases, differing)) do list[k] = group.label end
  return list
end

-- { { cases =, settings = { text of each } } }: groups of cases with different settings and the same effect. Repeats of a case
-- are no settings.
function remarks.equal(the)
  local groups, by_effect, names = {}, {}, axes_of(the)
  for _, case in ipairs(the.cases) do
    if points.good(case) and case.result.state then
      local key = effect_of(case)
      if not by_effect[key] then
        by_effect[key] = {}
        groups[#groups + 1] = by_effect[key]
      end
      table.insert(by_effect[key], case)
    end
  end
  local list = {}
  for _, group in ipairs(groups) do
    local settings = apart(group, names)
    if #settings > 1 then list[#list + 1] = { cases = group, settings = settings } end
  end
  return list
end

-- The title of a diagram, with the number of cases that are missing in it, and of those that change nothing.
function remarks.title(the, title)
  local count = 0
  for _, group in ipairs(remarks.equal(the)) do count = count + #group.cases end
  title = points.title(the, title)
  return count == 0 and title or ("%s (%d of %d cases are equal to others in effect)"):format(title, count, #the.cases)
end

local most_groups, most_settings = 4, 6

-- A line for each of the first groups.
function remarks.equal_lines(the)
  local groups, lines = remarks.equal(the), {}
  for k = 1, math.min(#groups, most_groups) do
    local group = groups[k]
    lines[k] = ("equal in effect, %s: %s%s end with the same positions, velocities, steps and measures, to the last bit"):format(
      numbers_of(group.cases), table.concat(group.settings, " | ", 1, math.min(#group.settings, most_settings)),
      #group.settings > most_settings and " ..." or "")
  end
  if #groups > most_groups then
    lines[#lines + 1] = ("equal in effect: %d more groups of cases, such as these"):format(#groups - most_groups)
  end
  return lines
end

return remarks
