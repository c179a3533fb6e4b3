-- What an optimisation is asked for: goals and controls of the scene (scene:goal{}, scene:control()) and of the command line.
local derivative = require("common.gradient.derivative")
local ranges = require("common.optimise.ranges")

local asked = {}

local function meant(wrong, names, otherwise)
  local near = hooke.nearest(wrong, names)
  return near and ("did you mean '%s'?"):format(near) or #names > 0 and "it has " .. table.concat(names, ", ") or otherwise
end

-- The goals of words "x=1,v=0"; or nil and what is wrong.
function asked.goals(words)
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
  return list
end

-- o.controls: those of the scene, or those of them that --by names; or nil and what is wrong.
function asked.choose_controls(o, explained)
  local list, names, wanted = {}, {}, nil
  for _, word in ipairs(o.by) do
    wanted = wanted or {}
    for name in word:gmatch("[^,%s]+") do wanted[name] = true end
  end
  local help = {}
  for _, p in ipairs(explained.parameters) do help[p.name] = p.help end
  for k, control in ipairs(explained.controls) do
    names[k], control.help = control.name, help[control.name]
    if not wanted or wanted[control.name] then list[#list + 1] = control end
    if wanted then wanted[control.name] = nil end
    control.min = control.min == control.min and control.min or nil
    control.max = control.max == control.max and control.max or nil
  end
  local unknown = wanted and next(wanted)
  if unknown then
    return nil, ("the scene has no control '%s'; %s"):format(unknown, meant(unknown, names, "it has none: scene:control(name, {})"))
  end
  if #list == 0 then return nil, "the scene has no control: scene:control(name, { knots = 31 })" end
  if #list > derivative.most then
    return nil, ("%d controls, and %d at a time are possible: --by"):format(#list, derivative.most)
  end
  for _, control in ipairs(list) do o.params[control.name] = nil end
  o.controls = list
  return true
end

-- Those with a value first.
local function in_order(goals)
  local list = {}
  for _, valued in ipairs { true, false } do
    for _, goal in ipairs(goals) do
      if (goal.value ~= nil) == valued then list[#list + 1] = goal end
    end
  end
  return list
end

-- What a measure that is `start` at the start has to change, about.
local function scale_of(goal, start)
  local most = math.abs(start)
  for _, key in ipairs { "value", "min", "max" } do
    if goal[key] then most = math.max(most, math.abs(goal[key] - start)) end
  end
  return most
end

-- o.goals: those of the command line at o.at, or those of the scene; o.at: when all is over. measures: at the start. Or nil and
-- what is wrong.
function asked.choose_goals(o, explained, measures)
  o.goals_named = #o.goals > 0
  if o.goals_named then
    for _, goal in ipairs(o.goals) do goal.at = o.at or explained.duration end
  else o.goals = in_order(explained.goals) end
  o.cost = explained.cost
  if #o.goals == 0 and not o.cost then
    return nil, "no goal: scene:goal{} in the script, or --goal MEASURE=NUMBER"
  end
  local names, last = {}, 0
  for name in pairs(measures) do names[#names + 1] = name end
  table.sort(names)
  for _, goal in ipairs(o.goals) do
    local start = measures[goal.name]
    if not start then
      return nil, ("the scene has no measure '%s'; %s"):format(goal.name,
        meant(goal.name, names, "it has none: scene:measure(name, function)"))
    end
    goal.scale, last = scale_of(goal, start), math.max(last, goal.at)
  end
  o.at = last > 0 and last or o.at or explained.duration
  return true
end

-- o.through, "PARAMETER=NUMBER,NUMBER,...", as { name =, numbers = }; the last number is the scene's. Or nil and what is wrong.
function asked.read_through(o)
  if not o.through then return true end
  local name, words = o.through:match("^%s*([%w_]+)%s*=%s*(.+)$")
  if not name then return nil, ("--through: '%s' is not PARAMETER=NUMBER,NUMBER"):format(o.through) end
  if o.params[name] then return nil, ("--through: %s is given already; the last number of --through is what it becomes"):format(name) end
  local numbers = {}
  for text in (words .. ","):gmatch("%s*([^,]*),") do
    local number = tonumber(text)
    if not number or number - number ~= 0 then return nil, ("--through: '%s' is not a number"):format(text) end
    if number == numbers[#numbers] then return nil, ("--through: %s is there twice"):format(text) end
    numbers[#numbers + 1] = number
  end
  o.params[name], o.through = ("%.17g"):format(numbers[#numbers]), { name = name, numbers = numbers }
  return true
end

-- o.stages: { params, goals, words, number } at every number of --through; explain(params) -> what the scene is with these, or nil
-- and why. Or nil and what is wrong.
function asked.choose_stages(o, explain)
  o.stages = {}
  for k, number in ipairs(o.through and o.through.numbers or {}) do
    local params, text = { [o.through.name] = ("%.17g"):format(number) }, ("%s=%.9g"):format(o.through.name, number)
    for key, value in pairs(o.params) do params[key] = params[key] or value end
    local explained, why = explain(params)
    if not explained then return nil, "--through: " .. why end
    local goals = o.goals_named and o.goals or in_order(explained.goals)
    if #goals ~= #o.goals then return nil, ("--through: with %s the scene has other goals"):format(text) end
    o.stages[k] = { params = params, goals = goals, words = text, number = number }
  end
  return true
end

local function goal_words(goal) return ("'%s' %s at %.9g s"):format(goal.name, ranges.words(goal), goal.at) end

-- Why goals cannot be met, of { row =, others = } (common/optimise/sqp.lua).
function asked.contradiction(o, found)
  local goal = o.goals[found.row]
  if not found.others then
    return ("the goal %s cannot be met within the bounds of the controls: wider bounds, or more time"):format(goal_words(goal))
  end
  if #found.others == 0 then
    return ("the goal %s cannot be met: the controls do not change it where they are; leave it out, add a control that does, or "
      .. "begin elsewhere (--starts 3)"):format(goal_words(goal))
  end
  local list = {}
  for k, row in ipairs(found.others) do list[k] = goal_words(o.goals[row]) end
  return ("the goal %s cannot be met beside %s: what changes it changes these, too, by another part; leave one out"):format(
    goal_words(goal), table.concat(list, ", "))
end

return asked
