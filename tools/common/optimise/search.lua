-- The search for optima: from the scene's own controls and from random ones, each again by an independent method, the best with
-- more knots.
local asked = require("common.optimise.asked")
local cost = require("common.optimise.cost")
local evaluation = require("common.optimise.evaluation")
local progress = require("common.run.progress")
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
  for g, goal in ipairs(o.goals) do negligible[g] = 1e-12 * math.max(goal.scale, math.abs(goal.value)) end
  local optimum, why, contradiction = sqp.minimise { start = weight:weighted(u), evaluate = measured, most = o.most,
    tolerance = o.tolerance, negligible = negligible, bounds = weight:bounds(controls),
    note = function(iteration, now, missing, y)
      note(iteration, now, missing)
      o.keep(with_values(controls, weight:values(y)))
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
  for level = 1, o.refine do
    local controls = refined(optimum.controls)
    local finer, why = optimum_from(o, controls, values_of(controls), function(iteration, now)
      bar:add { note = ("knots %d times closer, iteration %d, cost %.6g"):format(2 ^ level, iteration, now) }
    end)
    if not finer then
      optimum.unrefined = why
      break
    end
    finer.starts = optimum.starts
    optimum = finer
    levels[#levels + 1] = { knots = #controls[1].values, cost = finer.cost }
  end
  optimum.levels = levels
  return optimum
end

-- The optima, the cheapest first, those that are none last; or nil and why the first start fails.
function search.optima(o)
  local optima, first, why = {}, nil, nil
  local bar = progress.new { what = "optimise", quiet = o.quiet }
  for k = 1, o.starts + 1 do
    local u = k == 1 and values_of(o.controls) or within_bounds(o.controls, starts.random(o.controls, k, size_of(first)))
    local optimum, reason = optimum_from(o, o.controls, u, function(iteration, now, missing)
      bar:add { note = ("start %d of %d, iteration %d, cost %.6g, missing %.2g"):format(k, o.starts + 1, iteration, now, missing) }
    end)
    first, why = first or optimum, why or reason
    local known
    for _, other in ipairs(optima) do known = known or optimum and same(other, optimum) and other end
    if known then known.starts = known.starts + 1
    elseif optimum then
      optimum.starts = 1
      optima[#optima + 1] = optimum
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
