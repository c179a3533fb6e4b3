-- Functions shared by the diagrams of a sweep: the cases to draw, the axes that distinguish them, and their labels.
local points = {}

-- The parameters on the axes.
function points.over(figure)
  return type(figure.over) == "table" and figure.over or { figure.over }
end

function points.good(case)
  return case.result and (case.result.verdict == "ok" or case.result.verdict == "inaccurate")
end

function points.median(list)
  table.sort(list)
  local n = #list
  return n % 2 == 1 and list[(n + 1) // 2] or (list[n // 2] + list[n // 2 + 1]) / 2
end

-- What a figure shows of repeats: their median, or, of times on a busy machine, the least.
function points.of_repeats(figure, list)
  return figure.repeats == "least" and math.min(table.unpack(list)) or points.median(list)
end

-- A value for labels, without characters that would end a line of gnuplot's script.
function points.text(value)
  if math.type(value) == "integer" and math.abs(value) < 1000000 then return tostring(value) end
  return type(value) == "number" and ("%.4g"):format(value) or (tostring(value):gsub("%c", " "))
end

-- A value for comparisons, with all digits.
function points.exact(value)
  return math.type(value) == "float" and ("%.17g"):format(value) or tostring(value)
end

-- Axes that are neither on an axis of the figure nor repeats; samples do not get separate lines.
function points.others(the, over)
  local used, list = { ["repeat"] = true }, {}
  for _, name in ipairs(over) do used[name] = true end
  for _, axis in ipairs(the.axes) do
    if #axis.values > 1 and not used[axis.name] and not axis.joint then list[#list + 1] = axis.name end
  end
  return list
end

function points.label(case, names)
  local parts = {}
  for k, name in ipairs(names) do
    local value = points.text(case.values[name])
    parts[k] = (name == "integrator" or name == "scene") and value or name .. " = " .. value
  end
  return table.concat(parts, ", ")
end

-- Groups of cases with equal values of these axes, in the cases' order; each with its label.
function points.grouped(cases, names)
  local list, by_key = {}, {}
  for _, case in ipairs(cases) do
    local parts = {}
    for k, name in ipairs(names) do parts[k] = points.exact(case.values[name]) end
    local key = table.concat(parts, "\0")
    if not by_key[key] then
      by_key[key] = { label = points.label(case, names) }
      list[#list + 1] = by_key[key]
    end
    table.insert(by_key[key], case)
  end
  return list
end

-- The values of an axis, as they appear in the cases, and their scale; nil: there is no such axis.
function points.axis(the, name)
  for _, axis in ipairs(the.axes) do
    if axis.name == name then
      local list = {}
      for k, value in ipairs(axis.values) do list[k] = axis.kind == "integrator" and value.label or value end
      if axis.kind == "scene" then
        for k, value in ipairs(list) do list[k] = value:match("([^/]*)$"):gsub("%.lua$", "") end
      end
      return list, axis.values.scale
    end
  end
end

-- The title, with the number of cases that are missing in the picture.
function points.title(the, title)
  local count = 0
  for _, case in ipairs(the.cases) do
    if case.result and not points.good(case) then count = count + 1 end
  end
  return count == 0 and title or ("%s (%d of %d cases did not end well)"):format(title, count, #the.cases)
end

-- Whether the numbers on this axis are samples or measured values instead of a list.
function points.sampled(the, x)
  for _, axis in ipairs(the.axes) do
    if axis.name == x then return axis.joint end
  end
  return true -- a measure
end

-- Whether a logarithmic axis suits the numbers: above 0, and over a factor of 30.
function points.wants_log(numbers)
  local low, high = math.huge, 0
  for _, x in ipairs(numbers) do
    if x <= 0 then return false end
    low, high = math.min(low, x), math.max(high, x)
  end
  return high > 30 * low
end

return points
