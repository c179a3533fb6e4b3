-- hooke optimise SCENE.lua --goal x=1,v=0 [--by NAME,NAME] [name=value ...]: the controls that bring a scene to goals with least
-- effort. Goals are measures of the scene at the end; controls are functions of time that its script makes with
-- scripts/lib/control.lua; the effort is the integral of their squares. By gradients of the steps taken (one adjoint a
-- goal), from several starts; every optimum is run again by an independent method, and what it misses is said.
local argparse = require("argparse")
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local cost = require("common.optimise.cost")
local derivative = require("common.gradient.derivative")
local evaluation = require("common.optimise.evaluation")
local files = require("common.run.file")
local progress = require("common.run.progress")
local report = require("common.optimise.report")
local sqp = require("common.optimise.sqp")
local starts = require("common.optimise.starts")

-- The method that runs an optimum again: it chooses its steps, which are not those of the optimisation.
local independent, independent_tolerance = "dop853", 1e-11
local same_cost = 1e-5 -- relative: optima of several starts that are one

local function complain(format, ...) return command_line.complain("optimise", format:format(...)) end

local function parser()
  local p = argparse("hooke optimise", "The controls that bring a scene to goals with least effort.")
  p:argument("scene", "the scene's script, and values of parameters, name=value"):args("+")
  p:option("--goal", "measures and the values that they shall have, x=1,v=0"):count("*")
  p:option("--by", "the controls (all that the scene has)"):count("*")
  p:option("--at", "s, the time of the goals (the end)"):convert(command_line.positive("--at"))
  p:option("--starts", "how many random guesses, beside the scene's own"):default("0"):convert(function(text)
    return text == "0" and 0 or command_line.whole("--starts")(text)
  end)
  p:option("--most", "iterations, of each start"):default("100"):convert(command_line.whole("--most"))
  p:option("--tolerance", "of the controls, relative"):default("1e-7"):convert(command_line.positive("--tolerance"))
  p:option("--accuracy", "how far the independent method may miss a goal, relative"):default("1e-3")
    :convert(command_line.positive("--accuracy"))
  p:option("--integrator", "in place of the scene's")
  p:option("--without", "the label of a plugin that is left out"):count("*")
  p:option("--dt", "s, the longest step"):convert(command_line.positive("--dt"))
  p:option("--out", "where the results go (out/optimise/SCENE)")
  p:flag("--trust", "the scene may use plugins beside it")
  p:flag("--json", "the result as JSON on standard output")
  p:flag("--quiet", "no progress")
  return p
end

-- ---- what is asked for ----

local function goals_of(words)
  local list, seen = {}, {}
  for _, word in ipairs(words) do
    for piece in (word .. ","):gmatch("([^,]*),") do
      local name, text = piece:match("^%s*(.-)%s*=%s*(%S+)%s*$")
      local value = tonumber(text)
      if not value or value - value ~= 0 then return nil, ("--goal: '%s' is not MEASURE=NUMBER"):format(piece) end
      if seen[name] then return nil, ("--goal: %s is there twice"):format(name) end
      seen[name] = true
      list[#list + 1] = { name = name, value = value }
    end
  end
  if #list == 0 then return nil, "no goal: --goal MEASURE=NUMBER" end
  return list
end

-- A control by the text of a parameter; nil: it is another parameter.
local function control_of(p, given)
  local text = given[p.name] or p.initial
  local duration, list = tostring(text):match("^%s*([%d.eE+-]+):%s*(.*)$")
  if p.type ~= "string" or not tonumber(duration) then return nil end
  local values = {}
  for word in list:gmatch("%S+") do values[#values + 1] = tonumber(word) end
  return { name = p.name, duration = tonumber(duration), values = values }
end

local function controls_of(o, explained)
  local list, names, wanted = {}, {}, nil
  for _, word in ipairs(o.by) do
    wanted = wanted or {}
    for name in word:gmatch("[^,%s]+") do wanted[name] = true end
  end
  for _, p in ipairs(explained.parameters) do
    local control = control_of(p, o.params)
    if control then names[#names + 1] = p.name end
    if control and (not wanted or wanted[p.name]) then list[#list + 1] = control end
    if wanted and control then wanted[p.name] = nil end
  end
  local unknown = wanted and next(wanted)
  if unknown then
    local near = hooke.nearest(unknown, names)
    return nil, ("the scene has no control '%s'; %s"):format(unknown, near and ("did you mean '%s'?"):format(near)
      or #names > 0 and "it has " .. table.concat(names, ", ") or "it has none: require(\"control\")")
  end
  if #list == 0 then return nil, "the scene has no control: require(\"control\"), scripts/lib/control.lua" end
  if #list > derivative.most then
    return nil, ("%d controls, and %d at a time are possible: --by"):format(#list, derivative.most)
  end
  for _, control in ipairs(list) do o.params[control.name] = nil end
  return list
end

local function check_goals(o, measures)
  local names = {}
  for name in pairs(measures) do names[#names + 1] = name end
  table.sort(names)
  for _, goal in ipairs(o.goals) do
    local start = measures[goal.name]
    if not start then
      local near = hooke.nearest(goal.name, names)
      return nil, ("the scene has no measure '%s'; %s"):format(goal.name, near and ("did you mean '%s'?"):format(near)
        or #names > 0 and "it has " .. table.concat(names, ", ") or "it has none: scene:measure(name, function)")
    end
    goal.scale = math.max(math.abs(start), math.abs(goal.value - start))
  end
  return true
end

local function options()
  local o = command_line.parse("optimise", parser())
  if not o then return nil end
  local fine, why = command_line.take_scene("optimise", o)
  if not fine then return nil, why end
  o.goals, why = goals_of(o.goal)
  if not o.goals then return nil, why end
  o.independent = independent
  return o
end

local function ready(o)
  local explained, why = case_process.explain(o.scene, o.params, { trust = o.trust, integrator = o.integrator,
    without = o.without })
  if not explained then return nil, why end
  o.controls, why = controls_of(o, explained)
  if not o.controls then return nil, why end
  if o.at and o.at > explained.duration then
    return nil, ("--at: %g s is after the scene's duration, %g s"):format(o.at, explained.duration)
  end
  o.at = o.at or explained.duration
  local start = case_process.run { scene = o.scene, params = o.params, integrator = o.integrator, trust = o.trust,
    without = o.without, ["until"] = 0 }
  if not start.measures then return nil, start.failed end
  o.plugin = start.integrator
  local fine
  fine, why = check_goals(o, start.measures)
  if not fine then return nil, why end
  if not files.make_folder(o.out) then return nil, "cannot make the folder " .. o.out end
  return true
end

-- ---- the search ----

-- The controls with these values, one after the other.
local function with_values(controls, u)
  local list, at = {}, 0
  for j, control in ipairs(controls) do
    list[j] = { name = control.name, duration = control.duration, values = table.move(u, at + 1, at + #control.values, 1, {}) }
    at = at + #control.values
  end
  return list
end

local function values_of(controls)
  local u = {}
  for _, control in ipairs(controls) do table.move(control.values, 1, #control.values, #u + 1, u) end
  return u
end

local function evaluate(o, u, changes)
  local case = { parameters = with_values(o.controls, u) }
  for _, key in ipairs { "scene", "params", "goals", "at", "integrator", "dt", "tol", "trust", "without" } do case[key] = o[key] end
  for key, value in pairs(changes) do case[key] = value end
  return evaluation.take(case)
end

local function name_of(o, row) return o.goals[row].name end

-- An optimum from these values; or nil and why there is none.
local function optimum_from(o, u, bar, k)
  local last
  local function measured(y, gradient)
    local found = evaluate(o, o.weight:values(y), { gradient = gradient, careful = not o.tried })
    if found.failed then return nil, found.failed end
    o.tried, o.dt = o.tried or gradient, o.dt or found.dt
    last = gradient and found.misses or last
    local A = {}
    for g, slope in ipairs(gradient and found.slopes or {}) do A[g] = o.weight:slope(slope) end
    return { c = table.move(found.misses, 1, #found.misses, 1, {}), A = A }
  end
  local optimum, why, row = sqp.minimise { start = o.weight:weighted(u), evaluate = measured, most = o.most,
    tolerance = o.tolerance, note = function(iteration, now, missing)
      bar:add { note = ("start %d of %d, iteration %d, cost %.6g, missing %.2g"):format(k, o.starts + 1, iteration, now, missing) }
    end }
  if row then
    why = ("the goal '%s' cannot be met: the controls change it not at all, or not without the goals before it"):format(
      name_of(o, row))
  end
  if not optimum then return nil, why end
  optimum.misses, optimum.controls = last, with_values(o.controls, o.weight:values(optimum.y))
  return optimum
end

local function same(a, b)
  return a.ended == b.ended and math.abs(a.cost - b.cost) <= same_cost * math.max(a.cost, b.cost)
end

-- Guesses are as large as the first optimum, or 1 where there is none.
local function size_of(optimum)
  if not optimum then return 1 end
  local most = 0
  for _, value in ipairs(values_of(optimum.controls)) do most = math.max(most, math.abs(value)) end
  return most > 0 and most or 1
end

-- The optima, the cheapest first, those that are none last; or nil and why the first start fails.
local function search(o)
  local optima, first, why = {}, nil, nil
  local bar = progress.new { what = "optimise", quiet = o.quiet }
  o.weight = cost.of(o.controls)
  for k = 1, o.starts + 1 do
    local u = k == 1 and values_of(o.controls) or starts.random(o.controls, k, size_of(first))
    local optimum, reason = optimum_from(o, u, bar, k)
    first, why = first or optimum, why or reason
    local known
    for _, other in ipairs(optima) do known = known or optimum and same(other, optimum) and other end
    if known then known.starts = known.starts + 1
    elseif optimum then
      optimum.starts = 1
      optima[#optima + 1] = optimum
    end
  end
  bar:finish()
  if #optima == 0 then return nil, why end
  table.sort(optima, function(a, b)
    if (a.ended == "converged") ~= (b.ended == "converged") then return a.ended == "converged" end
    return a.cost < b.cost
  end)
  return optima
end

local function replay(o, optimum)
  optimum.replay = evaluate(o, values_of(optimum.controls), { integrator = independent, tol = independent_tolerance, dt = false })
  optimum.doubts = report.doubts(o, optimum)
end

local function main()
  local o, why = options()
  if not o then return why and complain("%s", why) or 1 end
  local fine
  fine, why = ready(o)
  if not fine then return complain("%s", why) end
  local optima
  optima, why = search(o)
  if not optima then return complain("%s", why) end
  for _, optimum in ipairs(optima) do replay(o, optimum) end
  fine, why = report.write(o, optima)
  if not fine then
    complain("%s", why)
    return 4
  end
  return #optima[1].doubts == 0 and 0 or 2
end

return main()
