-- What a fit has found: words on standard output, fit.json, fit.csv (data, fit and residuals), and a diagram of each measure.
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local description = require("common.run.description")
local files = require("common.run.file")
local journal = require("common.bench.journal")
local plot = require("common.run.plot")
local statistics = require("common.fit.statistics")

local report = {}

function report.values(o, p)
  local parts = {}
  for j, name in ipairs(o.names) do parts[j] = ("%s = %.9g"):format(name, p[j]) end
  return table.concat(parts, ", ")
end

local function number(x) return x == x and ("%.2g"):format(x) or "not known" end

-- ---- what may be wrong with it ----

-- "k and m: only k^0.71 m^-0.71 ..." in words: what may be changed together without a change of the measures.
local function blind_words(o, direction)
  local parts = {}
  for k, item in ipairs(direction) do
    parts[k] = ("%s by %+.3g %%"):format(o.names[item[1]], item[2] / math.abs(direction[1][2]))
  end
  if #parts == 1 then return ("%s changes none of these measures: the data do not determine it"):format(o.names[direction[1][1]]) end
  return ("the data do not tell %s apart: all measures stay as they are where one changes %s"):format(
    #parts == 2 and "the two" or "these", table.concat(parts, ", "))
end

-- Residuals that are each like the one before, and not for the steps; or that are far more than their deviations.
local function residual_words(o, best)
  local free, kinds, list, by_steps = #best.r - #best.p, {}, {}, 0
  for k, x in ipairs(o.observations) do kinds[k] = x.name end
  for _, x in ipairs(best.change or {}) do by_steps = by_steps + x * x end
  local serial = statistics.serial_correlation(best.r, kinds)
  if #best.r >= 10 and serial > 0.5 and best.cost > 100 * by_steps then
    list[1] = (("the residuals follow each other (correlation %.2f): the scene lacks what the data have, or there is a better "
      .. "minimum elsewhere: --starts 10"):format(serial))
  end
  local each = free > 0 and best.cost / free or 0
  if o.weighted and each > 1 + 5 * math.sqrt(2 / free) then
    list[#list + 1] = ("the scene does not explain the data within their deviations: the squares of the residuals are %.3g on "
      .. "average"):format(each)
  end
  return list
end

local function bound_words(o, best)
  local list = {}
  for j, name in ipairs(o.names) do
    if best.p[j] == o.low[j] or best.p[j] == o.high[j] then
      list[#list + 1] = ("%s is at its bound, %g: its deviation is not that of a minimum"):format(name, best.p[j])
    end
  end
  return list
end

-- Sentences on what is not as it should be, the first that make the answer unsure; and how many of these there are.
local function doubts(o, best)
  local list = {}
  if best.ended ~= "converged" then list[1] = "ended after " .. best.ended .. ", before a minimum: --most more" end
  if best.unrefined then list[#list + 1] = "the part of the steps is not known: " .. best.unrefined end
  for _, direction in ipairs(best.blind) do list[#list + 1] = blind_words(o, direction) end
  if best.run.verdict ~= "ok" then
    list[#list + 1] = ("the run with these values is not ok: %s"):format(best.run.reason or best.run.failed or best.run.verdict)
  end
  local words = residual_words(o, best)
  table.move(words, 1, #words, #list + 1, list)
  local unsure = #list
  words = bound_words(o, best)
  table.move(words, 1, #words, #list + 1, list)
  return list, unsure
end

function report.is_sure(best) return best.unsure == 0 end

-- ---- texts ----

local function head(o, best)
  local measures, seen = {}, {}
  for _, x in ipairs(o.observations) do
    if not seen[x.name] then measures[#measures + 1] = x.name end
    seen[x.name] = true
  end
  local setting = o.runs.adaptive and ("tolerance %.3g"):format(o.runs:setting(best.p, best.level).tol)
    or ("steps of %.4g s"):format(o.runs.dt / 2 ^ best.level)
  return ("%s: %s from %d numbers of %s (%s, %s, %d runs)"):format(o.scene:match("([^/]+)$"), table.concat(o.names, ", "),
    #o.observations, table.concat(measures, ", "), o.plugin, setting, o.runs.count)
end

local function correlations(o, best)
  local list = {}
  for j = 1, #best.p do
    for i = 1, j - 1 do
      local c = best.correlation[j][i]
      if c == c and math.abs(c) > 0.9 then list[#list + 1] = ("%s and %s %.4f"):format(o.names[i], o.names[j], c) end
    end
  end
  return list
end

local function largest(r)
  local most = 0
  for k = 1, #r do most = math.max(most, math.abs(r[k])) end
  return most
end

local function print_words(o, minima)
  local best = minima[1]
  print(head(o, best))
  print(("  %-16s %16s %12s %14s"):format("parameter", "value", "deviation", "by the steps"))
  for j, name in ipairs(o.names) do
    print(("  %-16s %16.9g %12s %14s  %s"):format(name, best.p[j], number(best.sd[j]),
      best.by_steps and number(best.by_steps[j]) or "not known", o.parameters[j].help or ""))
  end
  local rms = math.sqrt(best.cost / #best.r)
  print(("  residuals: rms %.4g%s, largest %.4g"):format(rms, o.weighted and " of their deviations" or "", largest(best.r)))
  local correlated = correlations(o, best)
  if #correlated > 0 then print("  correlated: " .. table.concat(correlated, "; ")) end
  for k = 1, #minima > 1 and #minima or 0 do
    print(("  minimum %d: %s, sum of squares %.6g, from %d start%s"):format(k, report.values(o, minima[k].p), minima[k].cost,
      minima[k].starts, minima[k].starts > 1 and "s" or ""))
  end
  for _, sentence in ipairs(best.doubts) do print("  " .. hooke.plain(sentence)) end
end

local function plain(x) return x == x and math.abs(x) < math.huge and x or journal.json.null end

local function state_json(o, state)
  local parameters = {}
  for j, name in ipairs(o.names) do
    local correlation = {}
    for i, other in ipairs(o.names) do correlation[other] = plain(state.correlation[j][i]) end
    parameters[name] = { value = state.p[j], deviation = plain(state.sd[j]), low = plain(o.low[j]), high = plain(o.high[j]),
      by_steps = state.by_steps and state.by_steps[j] or journal.json.null, correlation = correlation }
  end
  return { parameters = parameters, sum_of_squares = state.cost, numbers = #state.r, iterations = state.iterations,
    ended = state.ended, starts = state.starts }
end

local function json_text(o, minima)
  local list = {}
  for k, state in ipairs(minima) do list[k] = state_json(o, state) end
  return journal.json.encode { scene = o.scene, data = o.data, integrator = o.plugin, runs = o.runs.count, minima = list,
    answer = o.answer, doubts = #minima[1].doubts > 0 and minima[1].doubts or journal.json.empty_array, sure = report.is_sure(minima[1]) }
end

local function csv_text(o, best)
  local lines = { "t,measure,data,deviation,fit,residual" }
  for k, x in ipairs(o.observations) do
    local residual = best.r[k] * (x.sd or 1)
    lines[k + 1] = table.concat({ csv.cell(x.t), csv.text(x.name), csv.cell(x.value), csv.cell(x.sd),
      csv.cell(x.value + residual), csv.cell(residual) }, ",")
  end
  return table.concat(lines, "\n") .. "\n"
end

-- ---- diagrams ----

local function draw(o, best, name, path)
  local measured, fitted = {}, {}
  for k, x in ipairs(o.observations) do
    if x.name == name then
      measured[#measured + 1] = { x.t, x.value }
      fitted[#fitted + 1] = { x.t, x.value + best.r[k] * (x.sd or 1) }
    end
  end
  return plot.draw(path, { title = ("%s: %s"):format(o.scene:match("([^/]+)$"), report.values(o, best.p)),
    x = { label = "t, s" }, y = { label = name }, curves = {
      { title = "data", points = measured, marks = true },
      { title = "fit", points = fitted, lines = true } } })
end

-- Prints and writes everything; or nil and why not.
function report.write(o, minima)
  local best = minima[1]
  best.doubts, best.unsure = doubts(o, best)
  o.answer, o.unanswered = description.answer("fit", o, json_text(o, minima), "minima")
  local fine, why = files.write(o.out .. "/fit.json", json_text(o, minima) .. "\n")
  if fine then fine, why = files.write(o.out .. "/fit.csv", csv_text(o, best)) end
  local drawn = {}
  for _, x in ipairs(o.observations) do
    if fine and not drawn[x.name] then
      drawn[x.name] = true
      fine, why = draw(o, best, x.name, ("%s/%s"):format(o.out, x.name:gsub("[^%w_%-]", "_")))
    end
  end
  if o.json then command_line.print_json(json_text(o, minima)) else
    print_words(o, minima)
    if o.answer ~= nil then print(table.concat(description.lines(o.answer), "\n")) end
    print(("wrote %s/fit.json, fit.csv and a diagram of each measure"):format(o.out))
  end
  return fine and not o.unanswered, why or o.unanswered
end

return report
