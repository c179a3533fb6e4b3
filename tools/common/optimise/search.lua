-- The search for optima: from the scene's own controls and from random ones, each again by an independent method, the best with
-- more knots.
local asked = require("common.optimise.asked")
local cost = require("common.optimise.cost")
local evaluation = require("common.optimise.evaluation")
local process = require("process")
local progress = require("common.run.progress")
local segments = require("common.optimise.segments")
local sqp = require("common.optimise.sqp")
local starts = require("common.optimise.starts")

local search = {}

local same_cost = 1e-5 -- relative: optima of several starts that are one

-- The controls with these values, one after the other.
local function with_values(controls, u)
  local list, at = {}, 0
  for j, control in ipairs(controls) do
    list[j] = { name = control.name, duration = control.duration, min = control.min, max = control.max,
      values = table.move(u, at + 1, at + #control.values, 1, {}) }
    at = at + #control.values
  end
  return list
end

local function values_of(controls)
  local u = {}
  for _, control in ipairs(controls) do table.move(control.values, 1, #control.values, #u + 1, u) end
  return u
end

local function evaluate(o, controls, u, changes)
  local words = ("%s %s %s"):format(changes.gradient, changes.careful, changes.integrator or o.dt)
  return o.memory:recall(words, u, function()
    local case = { parameters = with_values(controls, u) }
    for _, key in ipairs { "scene", "params", "goals", "at", "cost", "fps", "integrator", "dt", "tol", "trust", "without" } do
      case[key] = o[key]
    end
    for key, value in pairs(changes) do case[key] = value end
    return evaluation.take(case)
  end)
end

-- What sqp asks for at y: the effort |y|^2, or the scene's own cost.
local function shown(o, y, weight, found, gradient)
  local there = { c = table.move(found.misses, 1, #found.misses, 1, {}), A = {} }
  there.cost, there.slope = found.cost, found.cost_slopes and weight:slope(found.cost_slopes)
  if not o.cost then
    there.cost, there.slope = 0, {}
    for k = 1, #y do there.cost, there.slope[k] = there.cost + y[k] ^ 2, 2 * y[k] end
  end
  for g, slope in ipairs(gradient and found.slopes or {}) do there.A[g] = weight:slope(slope) end
  return there
end

-- ---- by transcription ----

-- Every goal with the knot at which it is; or nil and why transcription cannot take these.
local function goals_at_knots(o, controls, goals)
  local first, list = controls[1], {}
  for _, control in ipairs(controls) do
    if #control.values ~= #first.values or control.duration ~= first.duration then
      return nil, ("--way transcription: %s and %s need the same knots"):format(first.name, control.name)
    end
  end
  if first.duration > o.at then
    return nil, ("--way transcription: %s goes on to %.9g s, after the last goal at %.9g s"):format(first.name, first.duration, o.at)
  end
  if o.cost and first.duration < o.at * (1 - 1e-9) then
    return nil, ("--way transcription: the cost is taken to %.9g s, after the last knot of %s at %.9g s: give the controls that duration")
      :format(o.at, first.name, first.duration)
  end
  for g, goal in ipairs(goals) do
    local place = goal.at / first.duration * (#first.values - 1)
    local knot = math.floor(place + 0.5)
    if math.abs(place - knot) > 1e-6 or knot > #first.values - 1 then
      return nil, ("--way transcription: the goal '%s' is at %.9g s, and no knot is"):format(goal.name, goal.at)
    end
    list[g] = { name = goal.name, value = goal.value, min = goal.min, max = goal.max, at = goal.at, knot = knot + 1 }
  end
  return list
end

local function bounds_of(controls)
  local bounds, at = cost.of(controls):bounds(controls), 0
  if not bounds then return nil end
  for _, control in ipairs(controls) do at = at + #control.values end
  return { low = bounds.low, high = bounds.high, values = function(p) return p end, row = function(k)
    local row = {}
    for j = 1, at do row[j] = j == k and 1 or 0 end
    return row
  end }
end

-- One search by transcription: of the scene with these params and goals, from controls u and states `nodes` (nil: those of --guess).
local function transcribed_with(o, controls, u, nodes, note, asked_for)
  local goals, why = goals_at_knots(o, controls, asked_for.goals)
  if not goals then return nil, why end
  local words = ("transcription %d %s %s %s"):format(#u, o.dt or "", o.guess, asked_for.words)
  local saved = o.memory:saved(words, u)
  o.dt = saved and saved.dt or o.dt
  local first, count = controls[1], #controls[1].values
  local case = { parameters = with_values(controls, saved and saved.u or u), goals = goals, params = asked_for.params,
    options = { start = u, saved = saved, nodes = nodes, guess = o.guess, interval = first.duration / (count - 1), knots = count,
      controls = #controls, goals = goals, negligible = asked_for.negligible, bounds = bounds_of(controls), most = o.most,
      tolerance = o.tolerance, own = o.cost ~= nil, save = function(state) o.memory:save(words, u, state) end,
      note = function(iteration, now, missing, values)
        note(iteration, now, missing)
        o.keep(with_values(controls, values), now, missing)
      end } }
  for _, key in ipairs { "scene", "at", "cost", "fps", "integrator", "dt", "tol", "trust", "without" } do case[key] = o[key] end
  local result = segments.minimise(case)
  why = result.contradiction and asked.contradiction(o, result.contradiction) or result.failed
  if not result.optimum then return nil, why end
  o.dt = o.dt or result.dt
  return result.optimum
end

-- b, or where it comes to by `part` of the way from a to it.
local function beyond(a, b, part)
  local list = {}
  for k = 1, #b do list[k] = type(b[k]) == "table" and beyond(a[k], b[k], part) or b[k] + part * (b[k] - a[k]) end
  return list
end

-- The guess at `number` from the optima before: the last one's controls and states, or those on the line through the last two
-- (Allgower and Georg, Introduction to numerical continuation methods, 2003, 2.2: the secant as a predictor).
local function predicted(before, last, number)
  if not before then return last.u, last.nodes end
  local part = (number - last.number) / (last.number - before.number)
  return beyond(before.u, last.u, part), beyond(before.nodes, last.nodes, part)
end

-- The optimum at the last number of --through by way of the others: each search begins at what those before it let expect.
local function led_through(o, controls, u, note, negligible)
  local before, last, iterations, nodes = nil, nil, 0, nil
  for k, stage in ipairs(o.stages) do
    if last then u, nodes = predicted(before, last, stage.number) end
    local optimum, why = transcribed_with(o, controls, u, nodes, note, { params = stage.params, goals = stage.goals,
      words = stage.words, negligible = negligible })
    if not optimum then return nil, ("--through: %s: %s"):format(stage.words, why) end
    iterations = iterations + optimum.iterations
    if optimum.ended ~= "converged" and k < #o.stages then
      return nil, ("--through: %s: it ended after %s: numbers that are closer"):format(stage.words, optimum.ended)
    end
    before, last, optimum.number = last, optimum, stage.number
  end
  last.iterations = iterations
  return last
end

-- As optimum_from below.
local function transcribed(o, controls, u, note, negligible)
  local optimum, why
  if o.stages and #o.stages > 0 then optimum, why = led_through(o, controls, u, note, negligible)
  else
    optimum, why = transcribed_with(o, controls, u, nil, note, { params = o.params, goals = o.goals, words = "",
      negligible = negligible })
  end
  if not optimum then return nil, why end
  local found = evaluate(o, controls, optimum.u, { gradient = false })
  if found.failed then return nil, found.failed end
  optimum.misses, optimum.controls, optimum.cost = found.misses, with_values(controls, optimum.u), found.cost or optimum.cost
  return optimum
end

-- An optimum from controls with the values u; or nil and why there is none.
local function optimum_from(o, controls, u, note)
  local weight, last, negligible = cost.of(controls), nil, {}
  local function measured(y, gradient)
    local found = evaluate(o, controls, weight:values(y), { gradient = gradient, careful = not o.tried })
    if found.failed then return nil, found.failed end
    o.tried, o.dt = o.tried or gradient, o.dt or found.dt
    last = gradient and found.misses or last
    return shown(o, y, weight, found, gradient)
  end
  for g, goal in ipairs(o.goals) do negligible[g] = 1e-12 * math.max(goal.scale, math.abs(goal.value or 0)) end
  if o.way == "transcription" then return transcribed(o, controls, u, note, negligible) end
  local optimum, why, contradiction = sqp.minimise { start = weight:weighted(u), evaluate = measured, most = o.most,
    tolerance = o.tolerance, negligible = negligible, goals = o.goals, bounds = weight:bounds(controls),
    note = function(iteration, now, missing, y)
      note(iteration, now, missing)
      o.keep(with_values(controls, weight:values(y)), now, missing)
    end }
  if contradiction then why = asked.contradiction(o, contradiction) end
  if not optimum then return nil, why end
  optimum.misses, optimum.controls = last, with_values(controls, weight:values(optimum.y))
  return optimum
end

local function same(a, b)
  return a.ended == b.ended and math.abs(a.cost - b.cost) <= same_cost * math.max(math.abs(a.cost), math.abs(b.cost))
end

-- Guesses are as large as the first optimum, or 1 where there is none.
local function size_of(optimum)
  if not optimum then return 1 end
  local most = 0
  for _, value in ipairs(values_of(optimum.controls)) do most = math.max(most, math.abs(value)) end
  return most > 0 and most or 1
end

local function within_bounds(controls, u)
  local at = 0
  for _, control in ipairs(controls) do
    for _ = 1, #control.values do
      at = at + 1
      u[at] = math.min(math.max(u[at], control.min or -math.huge), control.max or math.huge)
    end
  end
  return u
end

-- The controls with a knot more in every interval.
local function refined(controls)
  local list = {}
  for j, control in ipairs(controls) do
    local values = {}
    for k, value in ipairs(control.values) do
      if k > 1 then values[#values + 1] = (control.values[k - 1] + value) / 2 end
      values[#values + 1] = value
    end
    list[j] = { name = control.name, duration = control.duration, min = control.min, max = control.max, values = values }
  end
  return list
end

-- The optimum with more knots, o.refine times; levels: the costs, the first with the scene's own.
local function with_more_knots(o, optimum, bar)
  local levels = { { knots = #optimum.controls[1].values, cost = optimum.cost } }
  local from_here = setmetatable({ stages = false, guess = "run" }, { __index = o })
  for level = 1, o.refine do
    local controls = refined(optimum.controls)
    local interval = controls[1].duration / (#controls[1].values - 1)
    for _, control in ipairs(controls) do interval = math.min(interval, control.duration / (#control.values - 1)) end
    if from_here.dt and from_here.dt > interval then from_here.dt = interval end -- what is within a step no step can follow
    local finer, why = optimum_from(from_here, controls, values_of(controls), function(iteration, now)
      bar:add { note = ("knots %d times closer, iteration %d, cost %.6g"):format(2 ^ level, iteration, now) }
    end)
    if not finer then
      optimum.unrefined = why
      break
    end
    finer.starts = optimum.starts
    optimum, o.dt = finer, from_here.dt
    levels[#levels + 1] = { knots = #controls[1].values, cost = finer.cost }
  end
  optimum.levels = levels
  return optimum
end

-- Tells `bar` of the iterations of start k, and how long all that --most lets may still take, at the pace of those before; most
-- searches need fewer.
local function narrator(o, k, bar)
  local begun, first = process.clock(), nil
  return function(iteration, now, missing)
    first = first or iteration
    local left = ""
    if iteration > first then
      local each = (process.clock() - begun) / (iteration - first)
      left = (", %s left at most"):format(progress.duration(each * (o.most - iteration + (o.starts + 1 - k) * o.most)))
    end
    bar:add { note = ("start %d of %d, iteration %d of %d, cost %.6g, missing %.2g%s"):format(k, o.starts + 1, iteration, o.most,
      now, missing, left) }
  end
end

-- The optima, the cheapest first, those that are none last; or nil and why the first start fails.
function search.optima(o)
  local optima, first, why = {}, nil, nil
  local bar = progress.new { what = "optimise", quiet = o.quiet }
  o.bar = bar
  for k = 1, o.starts + 1 do
    local u = k == 1 and values_of(o.controls) or within_bounds(o.controls, starts.random(o.controls, k, size_of(first)))
    local optimum, reason = optimum_from(o, o.controls, u, narrator(o, k, bar))
    first, why = first or optimum, why or reason
    local known
    for _, other in ipairs(optima) do known = known or optimum and same(other, optimum) and other end
    if known then known.starts = known.starts + 1
    elseif optimum then
      optimum.starts = 1
      optima[#optima + 1] = optimum
      if optimum.ended == "converged" and not (o.best and o.best.cost <= optimum.cost) then o.best = optimum end
    end
  end
  table.sort(optima, function(a, b)
    if (a.ended == "converged") ~= (b.ended == "converged") then return a.ended == "converged" end
    return a.cost < b.cost
  end)
  if #optima > 0 and o.refine > 0 then optima[1] = with_more_knots(o, optima[1], bar) end
  bar:finish()
  if #optima == 0 then return nil, why end
  return optima
end

-- What an independent method, which chooses its steps, makes of an optimum.
function search.replay(o, optimum, independent, tolerance)
  optimum.replay = evaluate(o, optimum.controls, values_of(optimum.controls), { integrator = independent, tol = tolerance, dt = false })
end

return search
