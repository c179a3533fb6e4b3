-- The spread of a measure as its gradient has it: f(m) + g . (p - m) for every sample p of the parameters, with their mean m and the
-- gradient g of the steps that a run takes there (common/gradient/derivative.lua). Of a measure that is linear in what was sampled
-- that is what the samples say, to rounding; otherwise both differ by the measure's curvature: of a p^2 by a variance in the mean.
-- It costs a few runs instead of one a sample (first-order second moments: Taylor, An introduction to error analysis, 1997, 3.11).
local case_process = require("common.run.case_process")
local derivative = require("common.gradient.derivative")
local parameters = require("common.run.parameters")

local linear = {}

-- The sampled parameters, as gradients take them, at the mean of their values in these cases; or nil and why there are none.
local function parameters_of(the, cases)
  local list = {}
  for _, axis in ipairs(the.axes) do
    if axis.joint and axis.kind ~= "param" then return nil, axis.name .. " is sampled, which no measure is differentiated by" end
    if axis.joint then
      local mean = 0
      for _, case in ipairs(cases) do
        local value = case.values[axis.name]
        if not math.type(value) then return nil, axis.name .. " is no number" end
        mean = mean + value / #cases
      end
      list[#list + 1] = { name = axis.param, axis = axis.name, start = mean }
    end
  end
  return list
end

-- A case with the mean of the sampled parameters; or nil and why the scene does not take it.
local function case_at_mean(list, first)
  local case, sampled = { parameters = list, params = {} }, {}
  for _, key in ipairs { "scene", "integrator", "dt", "tol", "seed", "trust" } do case[key] = first[key] end
  for _, p in ipairs(list) do sampled[p.name] = true end
  for name, value in pairs(first.params) do
    if not sampled[name] then case.params[name] = value end
  end
  local explained, why = case_process.explain(case.scene, case.params, { trust = case.trust, integrator = case.integrator })
  if not explained then return nil, why end
  local fine
  fine, why = parameters.complete(list, explained, {})
  if not fine then return nil, why end
  case.at = first["until"] or explained.duration
  return case
end

-- The values that the measure has by its gradient, one a case; or nil and why there is none.
function linear.values(the, cases, measure)
  local list, why = parameters_of(the, cases)
  if not list then return nil, why end
  local case
  case, why = case_at_mean(list, cases[1])
  if not case then return nil, why end
  case.of = measure
  local found = derivative.take(case)
  if found.failed then return nil, found.failed end
  local values = {}
  for k, each in ipairs(cases) do
    values[k] = found.value
    for j, p in ipairs(list) do values[k] = values[k] + found.slopes[j] * (each.values[p.axis] - p.start) end
  end
  return values
end

return linear
