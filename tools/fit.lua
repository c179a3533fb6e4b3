-- hooke fit SCENE.lua --data FILE.csv --by NAME,NAME [name=value ...]: the parameters with which a scene agrees with data.
-- The data are measures of the scene at times, and their standard deviations where they are known. Least squares within
-- the bounds of param(), with standard deviations and correlations, combinations that the data do not determine, and the
-- part of the steps in the answer: they are refined until it does not matter. In the place of the scene may stand a script that
-- says all of this: return hooke.fit { scene = "FILE.lua", data = "FILE.csv", by = { "k" }, found = function(fit) ... end }.
local argparse = require("argparse")
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local data = require("common.fit.data")
local description = require("common.run.description")
local files = require("common.run.file")
local fitting = require("common.fit.fitting")
local interruption = require("common.run.interruption")
local journal = require("common.bench.journal")
local parameters = require("common.run.parameters")
local progress = require("common.run.progress")
local report = require("common.fit.report")
local runs = require("common.fit.runs")
local shape = require("common.fit.shape")

local function complain(format, ...) return command_line.complain("fit", format:format(...)) end

local function parser()
  local p = argparse("hooke fit", "The parameters with which a scene agrees with measured data.")
  p:argument("scene", "the scene's script, or one with hooke.fit{}, and values of parameters that are not fitted, name=value"):args("+")
  p:option("--data", "a table (CSV): t in s, measures of the scene, NAME_sd their standard deviations; cells may be empty")
  p:option("--shape", "in its place a table (CSV) of a still shape: particle, x, y, z, and sd or x_sd, y_sd, z_sd, m")
  p:option("--at", "when it has that shape: s, the end, or rest: where the scene comes to rest"):default("end")
  p:option("--by", "the parameters to find, k,c; with a start and bounds, k=20:1:1000 (those of param())"):count("*")
  p:option("--prior", "what is known of parameters beside the data, k=MEAN:DEVIATION"):count("*")
  p:option("--starts", "how many starts, over the bounds, beside the first"):default("0"):convert(function(text)
    if text == "0" then return 0 end
    return command_line.whole("--starts")(text)
  end)
  p:option("--tolerance", "of the least sum of squares: of the parameters, relative"):default("1e-6")
    :convert(command_line.positive("--tolerance"))
  p:option("--accuracy", "what the steps may do to the parameters, relative; or a tenth of their deviations, if that is more")
    :default("1e-3"):convert(command_line.positive("--accuracy"))
  p:option("--most", "iterations, of each start"):default("50"):convert(command_line.whole("--most"))
  p:option("--integrator", "in place of the scene's")
  p:option("--seed", "of the scene's chance"):convert(command_line.whole("--seed"))
  p:option("--jobs", "runs at a time (the processors)"):convert(command_line.whole("--jobs"))
  p:option("--out", "where the results go (out/fit/SCENE)")
  p:flag("--trust", "the scene may use plugins beside it")
  p:flag("--json", "the result as JSON on standard output")
  p:flag("--no-diagrams", "numbers alone, without the page and its diagrams, which take more time than a small scene"):target("no_diagrams")
  p:flag("--quiet", "no progress")
  return p
end

-- ---- data ----

-- All numbers of a measure have a deviation or none; several measures need them, since their units differ.
local function check_weights(list)
  local with, names, count = {}, {}, 0
  for _, o in ipairs(list) do
    local name = o.axis and "shape" or o.name -- all of which has one unit
    if with[name] == nil then
      with[name], count = o.sd ~= nil, count + 1
      names[count] = name
    end
    if with[name] ~= (o.sd ~= nil) then
      return nil, ("%s: some numbers have a standard deviation and some have none (line %d)"):format(name, o.line)
    end
  end
  if count > 1 then
    for _, name in ipairs(names) do
      if not with[name] then
        return nil, ("%d measures, and '%s' has no column %s_sd: their standard deviations weigh them"):format(count, name, name)
      end
    end
  end
  return with[names[1]]
end

-- The time of the shape, s, and o.shape; or nil and what is wrong.
local function take_time(o, explained)
  local t = o.at == "end" and explained.duration or o.at == "rest" and 0 or tonumber(o.at)
  if not t or t < 0 or t > explained.duration then
    return nil, ("--at: '%s' is no time of the run, 0 to %g s, nor end or rest"):format(o.at, explained.duration)
  end
  o.shape_of = { rest = o.at == "rest" }
  return t
end

local function read_shape(o, explained)
  local at, why = take_time(o, explained)
  if not at then return nil, why end
  local known = shape.particles { scene = o.scene, params = o.params, integrator = o.integrator, trust = o.trust, seed = o.seed }
  if not known.ids then return nil, known.failed end
  return shape.read(o.shape, known, at)
end

-- The observations, of measures or of a shape; or nil and what is wrong.
local function read_observations(o, explained, start)
  if o.shape then return read_shape(o, explained) end
  return data.read(o.data, start.measures, explained.duration, o.units)
end

local function read_data(o, explained)
  local start = case_process.run { scene = o.scene, params = o.params, integrator = o.integrator, trust = o.trust,
    seed = o.seed, ["until"] = 0 }
  if not start.measures then return nil, start.failed end
  o.units = explained.measure_units
  local list, why = read_observations(o, explained, start)
  if not list then return nil, why end
  local file = o.shape or o.data
  o.observations, o.plugin = list, start.integrator
  o.weighted, why = check_weights(list)
  if why then return nil, ("%s: %s"):format(file, why) end
  if o.prior_words[1] and not o.weighted then
    return nil, ("--prior: the data have no standard deviations, beside which a prior has a weight: a column %s_sd in %s"):format(
      list[1].name, file)
  end
  if #list + #o.prior_words < #o.parameters then
    return nil, ("%s: %d numbers cannot determine %d parameters: fit fewer, or measure more"):format(file, #list, #o.parameters)
  end
  return true
end

-- ---- fitting ----

local function is_adaptive(name)
  for _, p in ipairs((hooke.catalogue())) do
    if p.kind == "integrator" and p.name == name then return p.adaptive end
  end
end

-- o.priors[j] of each parameter, { mean =, sd = } or false; or nil and what is wrong.
local function take_priors(o)
  o.priors = {}
  for j in ipairs(o.parameters) do o.priors[j] = false end
  for _, word in ipairs(o.prior_words) do
    local at
    for j, p in ipairs(o.parameters) do at = p.name == word.name and j or at end
    if not at then return nil, ("--prior: %s is not fitted: name it in --by too"):format(word.name) end
    if o.priors[at] then return nil, ("--prior: %s is there twice"):format(word.name) end
    if not (word.start and word.low and not word.high) then
      return nil, ("--prior: %s: a mean and a standard deviation, %s=MEAN:DEVIATION"):format(word.name, word.name)
    end
    if math.abs(word.start) == math.huge or word.low == math.huge then
      return nil, ("--prior: %s: two finite numbers, %s=MEAN:DEVIATION"):format(word.name, word.name)
    end
    if word.low <= 0 then return nil, ("--prior: %s: the standard deviation, %g, is not above 0"):format(word.name, word.low) end
    o.priors[at] = { mean = word.start, sd = word.low }
  end
  return true
end

local function prepare(o)
  o.names, o.low, o.high, o.scale, o.first = {}, {}, {}, {}, {}
  for j, p in ipairs(o.parameters) do
    o.names[j], o.low[j], o.high[j], o.scale[j], o.first[j] = p.name, p.low, p.high, parameters.scale(p), p.start
    if o.starts > 0 and p.high - p.low == math.huge then
      return nil, ("--starts: %s has no bounds to spread starts over: --by %s=%g:LOW:HIGH"):format(p.name, p.name, p.start)
    end
  end
  local fine, wrong = take_priors(o)
  if not fine then return nil, wrong end
  local fingerprint = journal.of_scene(o.scene, o.params) .. journal.canonical { o.observations, o.names, o.integrator or "",
    o.seed or "", o.shape and o.at or "" }
  local why
  o.journal, why = journal.open(o.out .. "/runs.json", journal.hash(fingerprint))
  if not o.journal then return nil, why end
  o.runs = runs.new { scene = o.scene, names = o.names, observations = o.observations, given = o.params, trust = o.trust,
    seed = o.seed, integrator = o.integrator, adaptive = is_adaptive(o.plugin), tol = o.tol, journal = o.journal, jobs = o.jobs,
    priors = o.priors, shape = o.shape_of }
  return true
end

-- The minima, the least first, each with the number of starts that lead to it; or nil and why the first start fails.
local function search(o)
  local starts, minima = { o.first, table.unpack(fitting.starts(o.starts, o.low, o.high)) }, {}
  local bar = progress.new { what = "fit", quiet = o.quiet }
  o.bar, o.runs.tick = bar, function() bar:tick() end
  for k, start in ipairs(starts) do
    o.note = function(iteration, cost, p)
      report.keep(o, p, cost)
      bar:add { note = ("start %d of %d, iteration %d, sum of squares %.6g"):format(k, #starts, iteration, cost) }
    end
    local state, why = fitting.from(start, o)
    if not state and k == 1 then
      bar:finish()
      return nil, ("from the start, %s: %s"):format(report.values(o, start), why)
    end
    local known
    for _, other in ipairs(minima) do known = known or state and fitting.same(other, state, o) and other end
    if known then known.starts = known.starts + 1
    elseif state then
      state.starts = 1
      minima[#minima + 1] = state
    end
  end
  bar:finish()
  table.sort(minima, function(a, b) return a.cost < b.cost end)
  return minima
end

-- The scene's own verdict with the best values, over its whole duration.
local function judge(o, best)
  if o.at == "rest" then
    local there = o.runs:results({ best.p }, {})[1]
    return { verdict = there.unstable and "not stable" or "ok", reason = "after a push it does not come back to that equilibrium" }
  end
  local params, setting = {}, o.runs:setting(best.p, best.level)
  for name, value in pairs(o.params) do params[name] = value end
  for j, name in ipairs(o.names) do params[name] = ("%.17g"):format(best.p[j]) end
  return case_process.run { scene = o.scene, params = params, integrator = o.integrator, dt = setting.dt, tol = setting.tol,
    seed = o.seed, trust = o.trust, verify = true }
end

-- What hooke.fit{} of a script may say.
local fields = { scene = "scene", data = "data", shape = "data", at = "option", params = "params", by = "parameters",
  prior = "parameters", starts = "option", tolerance = "option", accuracy = "option", most = "option", integrator = "option",
  seed = "option", jobs = "option" }

local most_starts = 10000

local function options()
  local o, why = description.parse("fit", parser, fields)
  if not o then return nil, why end
  local fine
  fine, why = command_line.take_scene("fit", o)
  if not fine then return nil, why end
  if not (o.data or o.shape) then return nil, "no data: --data FILE.csv, or --shape FILE.csv" end
  if o.data and o.shape then return nil, "--data and --shape: give one of them" end
  if o.data and o.at ~= "end" then return nil, "--at is for --shape: the times of --data are in its column t" end
  if o.starts > most_starts then return nil, ("--starts: %d are more than %d: take fewer"):format(o.starts, most_starts) end
  o.parameters, why = parameters.wanted(o.by)
  if not o.parameters then return nil, why end
  o.prior_words = {}
  if #o.prior > 0 then o.prior_words, why = parameters.wanted(o.prior, "--prior") end
  if not o.prior_words then return nil, why end
  return o
end

local function ready(o)
  local explained, why = case_process.explain(o.scene, o.params, { trust = o.trust, integrator = o.integrator })
  if not explained then return nil, why end
  o.tol = explained.tol
  local fine
  fine, why = parameters.complete(o.parameters, explained, o.params)
  if not fine then return nil, why end
  fine, why = read_data(o, explained)
  if not fine then return nil, why end
  local made, refused = files.make_folder(o.out)
  if not made then return nil, refused end
  return prepare(o)
end

local now -- what is being fitted

local function main()
  local o, why = options()
  if not o then return why and complain("%s", why) or 1 end
  local fine
  now = o
  fine, why = ready(o)
  if not fine then return complain("%s", why) end
  local minima
  minima, why = search(o)
  if not minima then return complain("%s", why) end
  minima[1].run = judge(o, minima[1])
  fine, why = report.write(o, minima)
  if not fine then
    complain("%s", why)
    return o.unanswered and 1 or 4
  end
  o.journal:remove()
  report.forget(o)
  return report.is_sure(minima[1]) and 0 or 2
end

return interruption.guard("fit", main, function()
  if now and now.bar then now.bar:finish() end
  return report.interrupted(now or {})
end)
