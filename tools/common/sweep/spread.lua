-- What samples of a sweep say of a measure: mean, standard deviation and quantiles over the sampled axes (random, latin, normal),
-- for each combination of the other ones.
local csv = require("common.run.csv")
local files = require("common.run.file")
local points = require("common.sweep.points")
local rows = require("common.sweep.table")

local spread = {}

-- The quantile by linear interpolation between the values in order (Hyndman and Fan 1996, definition 7).
local function quantile(sorted, part)
  local at = 1 + part * (#sorted - 1)
  local k = math.min(math.floor(at), #sorted - 1)
  return #sorted == 1 and sorted[1] or sorted[k] + (at - k) * (sorted[k + 1] - sorted[k])
end

-- { count, mean, sd, low, median, high } of numbers; low and high: the quantiles of 5 and 95 %. nil: there are none.
function spread.of(list)
  local n, mean, squares = #list, 0, 0
  if n == 0 then return nil end
  for _, x in ipairs(list) do mean = mean + x / n end
  for _, x in ipairs(list) do squares = squares + (x - mean) ^ 2 end
  local sorted = table.move(list, 1, n, 1, {})
  table.sort(sorted)
  return { count = n, mean = mean, sd = n > 1 and math.sqrt(squares / (n - 1)) or 0 / 0, low = quantile(sorted, 0.05),
    median = quantile(sorted, 0.5), high = quantile(sorted, 0.95) }
end

-- The numbers that the measure has, and in which cases.
local function numbers(cases, name)
  local list, of = {}, {}
  for _, case in ipairs(cases) do
    local value = points.good(case) and rows.value(case, name)
    if math.type(value) and value == value and math.abs(value) < math.huge then list[#list + 1], of[#of + 1] = value, case end
  end
  return list, of
end

-- { label, measure, count, mean, ... } for each measure; of cases that ended well. Empty: nothing was sampled.
-- by_gradient: beside it `linear`, the same by the measure's gradient (common/sweep/linear.lua), or `why` there is none.
function spread.list(the, by_gradient)
  local linear = by_gradient and require("common.sweep.linear") -- which needs processes
  local list, sampled = {}, false
  for _, axis in ipairs(the.axes) do sampled = sampled or axis.joint end
  for _, group in ipairs(sampled and points.grouped(the.cases, points.others(the, {})) or {}) do
    for _, name in ipairs(rows.measures(the)) do
      local values, cases = numbers(group, name)
      local found = spread.of(values)
      if found and found.count > 1 then
        found.label, found.measure = group.label, name
        if linear then
          local of_gradient, why = linear.values(the, cases, name)
          found.linear, found.why = of_gradient and spread.of(of_gradient), why
        end
        list[#list + 1] = found
      end
    end
  end
  return list
end

local function line(s) return ("%.6g +- %.3g  %.6g  %.6g  %.6g"):format(s.mean, s.sd, s.low, s.median, s.high) end

function spread.show(list)
  if #list > 0 then print("  spread: mean, standard deviation, and the quantiles of 5, 50 and 95 %") end
  for _, s in ipairs(list) do
    local name = (s.label ~= "" and s.label .. "  " or "") .. hooke.plain(s.measure, true)
    print(("  %s  %s  (%d samples)"):format(name, line(s), s.count))
    if s.linear then print(("  %s  %s  (by the gradient)"):format(name, line(s.linear))) end
    if s.why then print(("  %s  has no gradient: %s"):format(name, hooke.plain(s.why, true))) end
  end
end

local function cells(s) return { csv.cell(s.mean), csv.cell(s.sd), csv.cell(s.low), csv.cell(s.median), csv.cell(s.high) } end

-- Writes them as a table; or nil and why not. by_gradient: with what gradients say, empty where there is none.
function spread.write(list, path, by_gradient)
  local more = ",linear_mean,linear_sd,linear_q05,linear_q50,linear_q95"
  local lines = { "of,measure,samples,mean,sd,q05,q50,q95" .. (by_gradient and more or "") }
  for k, s in ipairs(list) do
    local row = { csv.text(s.label), csv.text(s.measure), s.count, table.unpack(cells(s)) }
    lines[k + 1] = table.concat(row, ",")
    if by_gradient then lines[k + 1] = lines[k + 1] .. "," .. (s.linear and table.concat(cells(s.linear), ",") or ",,,,") end
  end
  return files.write(path, table.concat(lines, "\n") .. "\n")
end

return spread
