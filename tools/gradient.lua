-- hooke gradient SCENE.lua --of MEASURE --by NAME,NAME [name=value ...]: the derivative of a measure by parameters.
-- It is that of the steps taken: forwards, one tangent for each parameter, or backwards, one adjoint for all of them. Beside
-- it stand what half the step changes, what rounding leaves, and the derivative by whole runs, with which it has to agree. Where the
-- measure has a kink, and at bounds, it is given for each side; with contact, correctors and one-sided constraints by whole runs.
local argparse = require("argparse")
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local derivative = require("common.gradient.derivative")
local files = require("common.run.file")
local parameters = require("common.run.parameters")
local report = require("common.gradient.report")
local sides = require("common.gradient.sides")
local units = require("common.run.units")

local function complain(format, ...) return command_line.complain("gradient", format:format(...)) end

local function parser()
  local p = argparse("hooke gradient", "The derivative of a measure of a scene by its parameters.")
  p:argument("scene", "the scene's script, and values of other parameters, name=value"):args("+")
  p:option("--of", "the measure, as scene:measure() names it")
  p:option("--by", "the parameters, k,c; at another value than their own, k=20; or controls, by their values at knots"):count("*")
  p:option("--at", "s, the time at which the measure is taken (the end)"):convert(command_line.positive("--at"))
  p:option("--way", "forwards, backwards, or auto: backwards for more than eight parameters"):default("auto")
    :choices { "auto", "forwards", "backwards" }
  p:option("--integrator", "in place of the scene's")
  p:option("--without", "the label of a plugin that is left out"):count("*")
  p:option("--dt", "s, the longest step"):convert(command_line.positive("--dt"))
  p:option("--seed", "of the scene's chance"):convert(command_line.whole("--seed"))
  p:option("--out", "where the results go (out/gradient/SCENE)")
  p:flag("--trust", "the scene may use plugins beside it")
  p:flag("--json", "the result as JSON on standard output")
  return p
end

local function options()
  local o = command_line.parse("gradient", parser())
  if not o then return nil end
  local fine, why = command_line.take_scene("gradient", o)
  if not fine then return nil, why end
  if not o.of then return nil, "no measure: --of MEASURE" end
  o.parameters, why = parameters.wanted(o.by)
  if not o.parameters then return nil, why end
  return o
end

local function check_measure(o, measures)
  local names = {}
  for name in pairs(measures) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do
    if name == o.of then return true end
  end
  local near = hooke.nearest(o.of, names)
  return nil, ("the scene has no measure '%s'; %s"):format(o.of, near and ("did you mean '%s'?"):format(near)
    or #names > 0 and "it has " .. table.concat(names, ", ") or "it has none: scene:measure(name, function)")
end

-- Parameters that are controls get their `values` at knots and `duration`; or nil and what is wrong.
local function take_controls(o, controls)
  local by_name = {}
  for _, control in ipairs(controls) do by_name[control.name] = control end
  for _, p in ipairs(o.parameters) do
    local control = by_name[p.name]
    if control and p.start then
      return nil, ("--by: %s is a function of time: its values are given by %s=\"...\", as hooke optimise writes it"):format(p.name, p.name)
    end
    if control and o.way == "forwards" then
      return nil, ("--way forwards: %s is a function of time, whose values at knots are taken backwards"):format(p.name)
    end
    if control then
      p.values, p.duration, o.by_controls = control.values, control.duration, true
      o.params[p.name] = nil -- what is given are these values
    end
  end
  return true
end

-- Fills in what the scene says; or nil and what is wrong.
local function ready(o)
  local explained, why = case_process.explain(o.scene, o.params, { trust = o.trust, integrator = o.integrator,
    without = o.without })
  if not explained then return nil, why end
  local fine
  fine, why = take_controls(o, explained.controls)
  if not fine then return nil, why end
  fine, why = parameters.complete(o.parameters, explained, o.params)
  if not fine then return nil, why end
  if o.at and o.at > explained.duration then
    return nil, ("--at: %g s is after the scene's duration, %g s"):format(o.at, explained.duration)
  end
  if #o.parameters > derivative.most then
    return nil, ("--by: %d parameters, and %d at a time are possible"):format(#o.parameters, derivative.most)
  end
  o.at, o.unit = o.at or explained.duration, explained.measure_units[o.of]
  local known = units.of_parameters(explained.parameters)
  for _, p in ipairs(o.parameters) do p.unit = known[p.name] end
  local start = case_process.run { scene = o.scene, params = o.params, integrator = o.integrator, trust = o.trust,
    seed = o.seed, without = o.without, ["until"] = 0 }
  if not start.measures then return nil, start.failed end
  fine, why = check_measure(o, start.measures)
  if not fine then return nil, why end
  o.plugin = start.integrator
  o.backwards = o.way == "backwards" or o.by_controls or o.way == "auto" and #o.parameters > derivative.most_forwards
  local made, refused = files.make_folder(o.out)
  if not made then return nil, refused end
  return true
end

-- Integrators whose steps can be differentiated, and by name their order and whether they choose their steps.
local function methods()
  local names, order, adaptive = {}, {}, {}
  for _, p in ipairs((hooke.catalogue())) do
    if p.kind == "integrator" then order[p.name], adaptive[p.name] = p.order, p.adaptive end
    if p.kind == "integrator" and p.facets:find("stages/1", 1, true) then names[#names + 1] = p.name end
  end
  table.sort(names)
  return names, order, adaptive
end

-- Derivatives by the knots of a control go to found.knots; their sum, by all of it at once, stands in their place.
local function with_knots(o, found)
  found.knots = {}
  for j, p in ipairs(o.parameters) do
    found.knots[j] = p.values and found.slopes[j] or false
    if p.values then
      found.slopes[j] = 0
      for _, slope in ipairs(found.knots[j]) do found.slopes[j] = found.slopes[j] + slope end
    end
  end
  return found
end

local function case_of(o, changes)
  local case = {}
  for _, key in ipairs { "scene", "params", "parameters", "of", "at", "integrator", "dt", "seed", "trust", "backwards",
    "without" } do
    case[key] = o[key]
  end
  for key, value in pairs(changes) do case[key] = value end
  return case
end

local function take(o, changes)
  local found = derivative.take(case_of(o, changes))
  return found.slopes and with_knots(o, found) or found
end

-- ---- by whole runs, on both sides ----

-- What both sides of each parameter say that is wanted (else false), with steps of dt, and the run at the value itself; or nil and why
-- that fails.
local function both_sides(o, dt, wanted)
  local case, list = case_of(o, { dt = dt }), {}
  local here = sides.here(case)
  if not here.value then return nil, here.failed end
  case.dt = dt or not o.adaptive and here.dt or nil
  for j in ipairs(o.parameters) do list[j] = wanted(j) and sides.of(case, here.value, j) or false end
  return list, here
end

-- The same, and what half the step does to it where the method has fixed ones; third: why that is not known.
local function refined_sides(o, dt, gain, wanted)
  local list, here = both_sides(o, dt, wanted)
  if not list or o.adaptive then return list, here end
  local finer, refused = both_sides(o, here.dt / 2, function(j) return list[j] and sides.tells(list[j]) end)
  for j, both in ipairs(finer and list or {}) do
    if both and finer[j] then sides.refine(both, finer[j], gain / (gain - 1)) end
  end
  return list, here, not finer and refused or nil
end

-- In the place of the derivative of the steps, which is not to be had for this reason.
local function by_whole_runs(o, reason, gain)
  for _, p in ipairs(o.parameters) do
    if p.values then
      return nil, ("%s; whole runs, which tell it then, are not taken by the knots of '%s': take the derivative without it"):format(
        reason, p.name)
    end
  end
  local list, here, refused = refined_sides(o, o.dt, gain, function() return true end)
  if not list then return nil, here end
  local found = { whole = reason, value = here.value, dt = here.dt, steps = here.steps, inaccurate = here.inaccurate, sides = list,
    slopes = {}, rounding = {}, by_steps = {}, knots = {}, runs = {}, noise = {}, beside = {}, unrefined = refused }
  for j, both in ipairs(list) do
    local smooth = both.kind == "smooth"
    found.slopes[j] = smooth and (both[1].slope + both[-1].slope) / 2 or 0 / 0
    found.rounding[j] = smooth and math.max(both[1].error, both[-1].error) or 0 / 0
    found.by_steps[j] = smooth and both[1].by_steps and math.max(both[1].by_steps, both[-1].by_steps) or nil
    found.knots[j], found.beside[j] = false, {}
  end
  return found
end

-- Where the derivative of the steps may be that of one side alone.
local function look_at_both(o, found, gain)
  found.sides = {}
  local any = false
  local function wanted(j) return not o.parameters[j].values and report.suspects(found, j) end
  for j in ipairs(o.parameters) do any = any or wanted(j) end
  if not any then return end
  found.sides = refined_sides(o, o.dt or not found.tol and found.dt or nil, gain, wanted) or {}
  for j, both in ipairs(found.sides) do
    if both and (both.kind == "kink" or both.kind == "jump") then found.slopes[j] = 0 / 0 end
  end
end

-- ---- the derivative and its errors, from a run, one whose differences are wider, and one of half the step ----

local function add_errors(o, found, order, gain)
  local wider = take(o, { factor = derivative.wider, dt = o.dt or not found.tol and found.dt or nil })
  -- of a method that chooses its steps the error of one is that of its tolerance, of the next order
  local finer = take(o, { dt = found.dt / 2, tol = found.tol and found.tol / 2 ^ (order + 1) })
  found.rounding, found.by_steps, found.wider, found.unrefined = {}, {}, {}, finer.failed
  for j, slope in ipairs(found.slopes) do
    found.rounding[j] = wider.slopes and math.max(math.abs(wider.slopes[j] - slope), found.noise[j] / 128) or 0 / 0 -- or half a bit
    found.by_steps[j] = finer.slopes and math.abs(finer.slopes[j] - slope) * gain / (gain - 1)
    found.wider[j] = wider.slopes and wider.slopes[j]
  end
end

local function bound_of(o)
  for _, p in ipairs(o.parameters) do
    if sides.at_bound(p) then return ("%s = %.9g is at its bound, where a derivative is one-sided"):format(p.name, p.start) end
  end
end

local function by_steps(o, names, order, gain)
  local found = take(o, { compare = true })
  if found.failed and o.way == "auto" and o.backwards and not o.by_controls and found.failed:find("take it forwards", 1, true) then
    o.backwards = false
    found = take(o, { compare = true })
  end
  if found.failed and sides.replace(found.failed) then return by_whole_runs(o, found.failed:match("^[^:]*"), gain) end
  if found.failed then
    local other = found.failed:find("stages/1", 1, true) and "; there are " .. table.concat(names, ", ")
      or found.failed:find("kicks and drifts", 1, true) and "; these are leapfrog and symplectic_euler" or ""
    return nil, found.failed .. other
  end
  add_errors(o, found, order, gain)
  look_at_both(o, found, gain)
  return found
end

local function find(o)
  local names, orders, adaptive = methods()
  o.adaptive = adaptive[o.plugin]
  local order, bound = orders[o.plugin] or 1, bound_of(o)
  local found, why
  if bound then found, why = by_whole_runs(o, bound, 2 ^ order) else found, why = by_steps(o, names, order, 2 ^ order) end
  if not found then return nil, why end
  found.doubts, found.remarks = report.doubts(o, found), report.remarks(o, found)
  return found
end

local function main()
  local o, why = options()
  if not o then return why and complain("%s", why) or 1 end
  local fine
  fine, why = ready(o)
  if not fine then return complain("%s", why) end
  local found
  found, why = find(o)
  if not found then return complain("%s", why) end
  fine, why = report.write(o, found)
  if not fine then
    complain("%s", why)
    return 4
  end
  return #found.doubts == 0 and 0 or 2
end

return main()
