-- What a fit has found: words on standard output, fit.json, fit.csv (data, fit and residuals), and a page with diagrams: of
-- each measure, of the residuals and of the confidence in each two parameters, whose names have a dot, as no measure's has.
local answer_page = require("common.run.answer_page")
local command_line = require("common.run.command_line")
local csv = require("common.run.csv")
local description = require("common.run.description")
local files = require("common.run.file")
local journal = require("common.bench.journal")
local least_squares = require("common.fit.least_squares")
local plot = require("common.run.plot")
local statistics = require("common.fit.statistics")
local units = require("common.run.units")

local report = {}

-- The best of this moment, as words to run the scene with: what is left of a fit that is ended.
function report.keep(o, p, cost)
  if o.kept and o.kept <= cost then return end
  o.kept, o.kept_values = cost, p
  local words = {}
  for j, name in ipairs(o.names) do words[j] = ("%s=%.17g"):format(name, p[j]) end
  files.write(o.out .. "/now.txt", table.concat(words, " ") .. "\n")
end

-- What is left of a fit that is interrupted, behind that word.
function report.interrupted(o)
  local count = o.runs and o.journal.count + o.runs.count or 0
  if count == 0 then return " before its first run: nothing is kept, and the same command begins again" end
  local kept = ("%d run%s kept in %s/runs.json, from which the same command goes on"):format(count, count == 1 and " is" or "s are", o.out)
  if not o.kept then return (" before its first iteration: %s"):format(kept) end
  return (": the best so far, %s with a sum of squares of %.6g, stands in %s/now.txt, and %s"):format(report.values(o, o.kept_values),
    o.kept, o.out, kept)
end

function report.forget(o) os.remove(o.out .. "/now.txt") end

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
  if #parts == 1 then
    return ("%s changes none of these measures: the data do not determine it; leave it out"):format(o.names[direction[1][1]])
  end
  return ("the data do not tell %s apart: all measures stay as they are where one changes %s; hold one, or give a --prior"):format(
    #parts == 2 and "the two" or "these", table.concat(parts, ", "))
end

-- Of the data's size: below it residuals are those of the runs' own rounding and of equations that are solved.
local rounding = 1e-9

local function is_rounding(o, best)
  local most, size = 0, 0
  for k, x in ipairs(o.observations) do
    most, size = math.max(most, math.abs(best.r[k]) * (x.sd or 1)), math.max(size, math.abs(x.value))
  end
  return most <= rounding * size
end

-- Residuals that are each like the one before, and not for the steps; or that are far more than their deviations.
local function residual_words(o, best)
  local free, kinds, list, by_steps = #best.r - #best.p, {}, {}, 0
  for k = 1, #best.r do kinds[k] = o.observations[k] and o.observations[k].name or k end -- a prior is one of its kind
  for _, x in ipairs(best.change or {}) do by_steps = by_steps + x * x end
  local serial = statistics.serial_correlation(best.r, kinds)
  if #best.r >= 10 and serial > 0.5 and best.cost > 100 * by_steps and not is_rounding(o, best) then
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

-- Beyond a bend of a fifth one side has one and a half times the slope of the other.
local most_bent = 0.2

local function bend_words(o, best)
  local list = {}
  for j, name in ipairs(o.names) do
    if best.bends[j] > most_bent and best.sd[j] == best.sd[j] then
      list[#list + 1] = (("%s: the measures have a kink or jump at this value (other particles, a contact, a slack rope): its "
        .. "deviation says nothing; look at both sides with hooke sweep"):format(name))
    end
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
  if best.ended == least_squares.stuck then
    list[1] = "no step makes the squares smaller, and by the derivatives some should: the measures have a kink or jump at these "
      .. "values (other particles, a contact, a slack rope), or their errors jump (steps that the method chooses): look at both sides "
      .. "with hooke sweep"
  elseif best.ended ~= "converged" then list[1] = "ended after " .. best.ended .. ", before a minimum: --most more" end
  if best.unrefined then list[#list + 1] = "the part of the steps is not known: " .. best.unrefined end
  for _, direction in ipairs(best.blind) do list[#list + 1] = blind_words(o, direction) end
  if best.run.verdict ~= "ok" then
    list[#list + 1] = ("the run with these values is not ok: %s"):format(best.run.reason or best.run.failed or best.run.verdict)
  end
  for _, words in ipairs { bend_words(o, best), residual_words(o, best) } do table.move(words, 1, #words, #list + 1, list) end
  local unsure = #list
  local words = bound_words(o, best)
  table.move(words, 1, #words, #list + 1, list)
  if #best.r == #best.p and not o.weighted then
    list[#list + 1] = ("there are as many parameters as numbers: what is left of these tells no deviations; a column %s_sd does"):format(
      o.observations[1].name)
  end
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
  if o.shape then measures = { "a shape" } end
  local setting = o.at == "rest" and "at rest" or o.runs.adaptive and ("tolerance %.3g"):format(o.runs:setting(best.p, best.level).tol)
    or ("steps of %.4g s"):format(o.runs.dt / 2 ^ best.level)
  return ("%s: %s from %d numbers of %s (%s%s, %d runs)"):format(o.scene:match("([^/]+)$"), table.concat(o.names, ", "),
    #o.observations, table.concat(measures, ", "), o.at == "rest" and "" or o.plugin .. ", ", setting, o.runs.count)
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

local function largest(r, count)
  local most = 0
  for k = 1, count do most = math.max(most, math.abs(r[k])) end
  return most
end

-- A row for each parameter, below the heads of the columns.
local function rows_of(o, best)
  local rows = { { "parameter", "value", "deviation", "by the steps" } }
  for j, name in ipairs(o.names) do
    rows[1 + j] = { name, ("%.9g"):format(best.p[j]), number(best.sd[j]), best.by_steps and number(best.by_steps[j]) or "not known",
      o.parameters[j].help or "" }
  end
  return rows
end

-- What is said below the parameters.
local function further(o, minima)
  local best, squares = minima[1], 0
  for k in ipairs(o.observations) do squares = squares + best.r[k] ^ 2 end
  local list = { ("residuals: rms %.4g%s, largest %.4g"):format(math.sqrt(squares / #o.observations),
    o.weighted and " of their deviations" or "", largest(best.r, #o.observations)) }
  local correlated = correlations(o, best)
  if #correlated > 0 then list[2] = "correlated: " .. table.concat(correlated, "; ") end
  for k = 1, #minima > 1 and #minima or 0 do
    list[#list + 1] = ("minimum %d: %s, sum of squares %.6g, from %d start%s"):format(k, report.values(o, minima[k].p), minima[k].cost,
      minima[k].starts, minima[k].starts > 1 and "s" or "")
  end
  return list
end

local function print_words(o, minima)
  local best = minima[1]
  print(head(o, best))
  for _, row in ipairs(rows_of(o, best)) do
    print(("  %-16s %16s %12s %14s%s"):format(row[1], row[2], row[3], row[4], row[5] and "  " .. row[5] or ""))
  end
  for _, text in ipairs(further(o, minima)) do print("  " .. text) end
  for _, sentence in ipairs(best.doubts) do print("  " .. hooke.plain(sentence)) end
end

local function plain(x) return x == x and math.abs(x) < math.huge and x or journal.json.null end

local function state_json(o, state)
  local parameters = {}
  for j, name in ipairs(o.names) do
    local correlation = {}
    for i, other in ipairs(o.names) do correlation[other] = plain(state.correlation[j][i]) end
    parameters[name] = { value = state.p[j], deviation = plain(state.sd[j]), low = plain(o.low[j]), high = plain(o.high[j]),
      by_steps = state.by_steps and state.by_steps[j] or journal.json.null, correlation = correlation,
      prior = o.priors[j] or journal.json.null }
  end
  return { parameters = parameters, sum_of_squares = state.cost, numbers = #o.observations, iterations = state.iterations,
    ended = state.ended, starts = state.starts }
end

local function json_text(o, minima)
  local list = {}
  for k, state in ipairs(minima) do list[k] = state_json(o, state) end
  return journal.encode { scene = o.scene, data = o.data or journal.json.null, shape = o.shape or journal.json.null,
    at = o.shape and o.at or journal.json.null, integrator = o.plugin, runs = o.runs.count, minima = list,
    answer = o.answer == nil and journal.json.null or o.answer, doubts = journal.list(minima[1].doubts),
    sure = report.is_sure(minima[1]) }
end

local function csv_text(o, best)
  local lines = { "t,measure,data,deviation,fit,residual" }
  for k, x in ipairs(o.observations) do
    local residual = best.r[k] * (x.sd or 1)
    lines[k + 1] = table.concat({ csv.cell(o.at ~= "rest" and x.t or nil), csv.text(x.particle and ("%s of %d"):format(x.name,
      x.particle) or x.name), csv.cell(x.value), csv.cell(x.sd),
      csv.cell(x.value + residual), csv.cell(residual) }, ",")
  end
  return table.concat(lines, "\n") .. "\n"
end

-- ---- diagrams ----

-- Where an observation stands: at its time, or a shape's at its particle.
local function place_of(x) return x.particle or x.t end

local function draw(o, best, name, path)
  local measured, fitted = {}, {}
  for k, x in ipairs(o.observations) do
    if x.name == name then
      measured[#measured + 1] = { place_of(x), x.value }
      fitted[#fitted + 1] = { place_of(x), x.value + best.r[k] * (x.sd or 1) }
    end
  end
  return plot.draw(path, { title = ("%s: %s"):format(o.scene:match("([^/]+)$"), report.values(o, best.p)),
    x = { label = o.shape and "particle" or "t, s" },
    y = { label = units.label(name, o.shape and "m" or o.units[name]) }, curves = {
      { title = "data", points = measured, lines = false },
      { title = "fit", points = fitted, marks = false } } })
end

-- Without deviations the data are of one measure.
local function residual_axis(o)
  if o.weighted then return "(fit - data)/deviation" end
  local unit = o.units[o.observations[1].name]
  return unit and units.label("fit - data", unit) or "fit - data, in the unit of the measure"
end

-- All residuals in time, by their deviations where these are given.
local function draw_residuals(o, best)
  local curves, by_name = {}, {}
  for k, x in ipairs(o.observations) do
    local curve = by_name[x.name] or { title = x.name, points = {}, lines = false }
    if not by_name[x.name] then curves[#curves + 1], by_name[x.name] = curve, curve end
    curve.points[#curve.points + 1] = { place_of(x), best.r[k] }
  end
  return plot.draw(o.out .. "/fit.residuals", { title = ("%s: residuals"):format(o.scene:match("([^/]+)$")),
    x = { label = o.shape and "particle" or "t, s" }, y = { label = residual_axis(o) }, curves = curves })
end

-- Of two parameters the ellipse (p - best)^T C^-1 (p - best) = limit, C their covariance: with its axes x = a cos u, y = b sin(u + f),
-- sin f the correlation.
local function ellipse(best, i, j, limit)
  local points, turn, size = {}, math.asin(best.correlation[i][j]), math.sqrt(limit)
  for k = 0, 100 do
    local u = 2 * math.pi * k / 100
    points[k + 1] = { best.p[i] + size * best.sd[i] * math.cos(u), best.p[j] + size * best.sd[j] * math.sin(u + turn) }
  end
  return points
end

-- Of two normally distributed numbers P(chi^2 < limit) = 1 - exp(-limit/2); where their variance is what `free` residuals say,
-- chi^2/2 is distributed as F(2, free), and P(2 F < limit) = 1 - (1 + limit/free)^(-free/2).
local function limit_of(probability, free)
  if not free then return -2 * math.log(1 - probability) end
  return free * ((1 - probability) ^ (-2 / free) - 1)
end

local function axis_of(o, j)
  local help = o.parameters[j].help
  return { label = help and help ~= "" and ("%s (%s)"):format(o.names[j], help) or o.names[j] }
end

-- Where two parameters lie together with a probability of 68 and of 95 %, for each pair whose deviations are known.
local function draw_confidence(o, best, figures)
  for j = 2, #best.p do
    for i = 1, j - 1 do
      local c = best.correlation[i][j]
      if c == c and math.abs(c) <= 1 and best.sd[i] > 0 and best.sd[j] > 0 then
        local curves = { { title = "best", points = { { best.p[i], best.p[j] } }, lines = false } }
        for k, probability in ipairs { 0.68, 0.95 } do
          local limit = limit_of(probability, not o.weighted and #best.r - #best.p)
          curves[1 + k] = { title = ("%.0f %%"):format(100 * probability), points = ellipse(best, i, j, limit), marks = false }
        end
        local path = ("%s/fit.confidence-%s-%s"):format(o.out, o.names[i], o.names[j])
        local fine, why = plot.draw(path, { title = ("%s: confidence, linear, correlation %.4f"):format(o.scene:match("([^/]+)$"), c),
          x = axis_of(o, i), y = axis_of(o, j), curves = curves })
        if not fine then return nil, why end
        local words = "where %s and %s lie together with a probability of 68 and of 95 %%, linearly"
        figures[#figures + 1] = { path = path, caption = words:format(o.names[i], o.names[j]) }
      end
    end
  end
  return true
end

-- A diagram of each measure, of the residuals, and of the confidence in each two parameters, as answer_page has them; or nil and why not.
local function draw_all(o, best)
  local figures, drawn = {}, {}
  for _, x in ipairs(o.observations) do
    if not drawn[x.name] then
      local path = ("%s/%s"):format(o.out, x.name:gsub("[^%w_%-]", "_"))
      local fine, why = draw(o, best, x.name, path)
      if not fine then return nil, why end
      drawn[x.name], figures[#figures + 1] = true, { path = path, caption = x.name .. ": data and fit" }
    end
  end
  local fine, why = draw_residuals(o, best)
  if not fine then return nil, why end
  figures[#figures + 1] = { path = o.out .. "/fit.residuals", caption = "residuals" }
  fine, why = draw_confidence(o, best, figures)
  if not fine then return nil, why end
  return figures
end

-- The diagrams and the page with them.
local function write_page(o, minima)
  local figures, why = draw_all(o, minima[1])
  if not figures then return nil, why end
  local doubts_of, lines = {}, further(o, minima)
  for k, text in ipairs(minima[1].doubts) do doubts_of[k] = hooke.plain(text) end
  return answer_page.write(o.out .. "/page.html", { title = ("%s: %s"):format(o.scene:match("([^/]+)$"), report.values(o, minima[1].p)),
    head = head(o, minima[1]), doubts = doubts_of, tables = { { rows = rows_of(o, minima[1]) } }, lines = lines, figures = figures })
end

-- Prints and writes everything; or nil and why not.
function report.write(o, minima)
  local best = minima[1]
  best.doubts, best.unsure = doubts(o, best)
  o.answer, o.unanswered = description.answer("fit", o, json_text(o, minima), "minima")
  local fine, why = files.write(o.out .. "/fit.json", json_text(o, minima) .. "\n")
  if fine then fine, why = files.write(o.out .. "/fit.csv", csv_text(o, best)) end
  if fine and not o.no_diagrams then fine, why = write_page(o, minima) end
  if o.json then command_line.print_json(json_text(o, minima)) else
    print_words(o, minima)
    if o.answer ~= nil then print(table.concat(description.lines(o.answer), "\n")) end
    print(("wrote %s/fit.json, fit.csv%s"):format(o.out, o.no_diagrams and "" or ", page.html and its diagrams: of each measure, of the "
      .. "residuals and of the confidence in each two parameters"))
  end
  return fine and not o.unanswered, why or o.unanswered
end

return report
