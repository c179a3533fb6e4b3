-- Makes the list of cases of a sweep's definition (scripts/sweeps/README.md): the product of all lists, the last
-- varying fastest, where sampled axes (random, latin) form one list of joint samples. The list depends on the
-- definition only, so the number of a case suffices to run it on another host.
local child = require("common.sweep.child")
local ranges = require("ranges")

local plan = {}

local fields = { "scene", "params", "integrators", "solvers", "dt", "tol", "until", "accuracy", "verify", "measures",
  "paths", "plots", "repeats", "seed", "step_limit", "timeout", "jobs", "threads", "trust", "name", "folder" }

-- Raises an error for the user, without a place in this file.
function plan.refuse(text, ...)
  error(("sweep: " .. text):format(...), 0)
end

-- The error text of an unknown name, with the nearest known one.
function plan.unknown(what, name, list)
  local near = hooke.nearest(tostring(name), list)
  plan.refuse("there is no %s '%s'; %s", what, tostring(name),
    near and ("did you mean '%s'?"):format(near) or "there are: " .. table.concat(list, ", "))
end

local function check_names(what, given, list)
  local known = {}
  for _, name in ipairs(list) do known[name] = true end
  for name in pairs(given) do
    if not known[name] then plan.unknown(what, name, list) end
  end
end

-- ---- axes ----

local function plain(value)
  return math.type(value) == "float" and math.tointeger(value) or value
end

local function values_of(name, given, seed)
  if type(given) ~= "table" then return { plain(given) } end
  if given.sample then return ranges.draw(given, seed, name), true end
  if #given == 0 then plan.refuse("%s: the list of values is empty", name) end
  local list = { scale = given.scale }
  for k, value in ipairs(given) do
    local kind = type(value)
    if kind ~= "number" and kind ~= "string" and kind ~= "boolean" then
      plan.refuse("%s: value %d is a %s; expected a number, a text or true or false", name, k, kind)
    end
    list[k] = plain(value)
  end
  return list
end

local function is_positive(x) return type(x) == "number" and x > 0 end

local function positive(name, list)
  for _, x in ipairs(list) do
    if not is_positive(x) then plan.refuse("%s: '%s' is not a positive number", name, tostring(x)) end
  end
  return list
end

-- "name:parameter=value,..." or { that, dt =, tol =, solver =, label = } -> the table.
local function method_of(entry)
  if type(entry) == "string" then return { text = entry, label = entry } end
  if type(entry) ~= "table" or type(entry[1]) ~= "string" then
    plan.refuse("integrators: an entry is a name or { name, dt =, tol =, solver =, label = }")
  end
  for key in pairs(entry) do
    if key ~= 1 then
      check_names("field of an integrator's entry", { [key] = true }, { "dt", "tol", "solver", "label" })
    end
  end
  local parts = { entry[1] }
  for _, key in ipairs { "dt", "tol", "solver" } do
    if entry[key] then parts[#parts + 1] = ("%s %s"):format(key, type(entry[key]) == "number"
      and ("%.6g"):format(entry[key]) or entry[key]) end
  end
  return { text = entry[1], dt = entry.dt, tol = entry.tol, solver = entry.solver,
    label = entry.label or table.concat(parts, " ") }
end

local function methods_of(given)
  local list = {}
  for k, entry in ipairs(type(given) == "table" and given or { given }) do list[k] = method_of(entry) end
  return list
end

local function sorted_keys(t)
  local list = {}
  for key in pairs(t) do list[#list + 1] = key end
  table.sort(list)
  return list
end

local function repeats_of(definition)
  local n = definition.repeats or 1
  if math.type(n) ~= "integer" or n < 1 then plan.refuse("repeats: expected a whole number from 1") end
  local list = {}
  for k = 1, n do list[k] = k end
  return list
end

local taken = { scene = true, integrator = true, solver = true, dt = true, tol = true, ["repeat"] = true }

-- { name, kind, values, joint }: kind "param" or the name itself.
local function axes_of(definition)
  local axes = {}
  local function add(name, kind, values, joint)
    axes[#axes + 1] = { name = name, kind = kind, values = values, joint = joint }
  end
  local seed = definition.seed or 0
  add("scene", "scene", (values_of("scene", definition.scene)))
  for _, name in ipairs(sorted_keys(definition.params or {})) do
    add(taken[name] and "param " .. name or name, "param", values_of(name, definition.params[name], seed))
    axes[#axes].param = name
  end
  if definition.solvers then add("solver", "solver", (values_of("solvers", definition.solvers))) end
  if definition.integrators then add("integrator", "integrator", methods_of(definition.integrators)) end
  for _, name in ipairs { "dt", "tol" } do
    if definition[name] then add(name, name, positive(name, (values_of(name, definition[name], seed)))) end
  end
  if (definition.repeats or 1) ~= 1 then add("repeat", "repeat", repeats_of(definition)) end
  return axes
end

-- ---- the product ----

-- The dimensions of the product: each list is one, all sampled axes together are one.
local function dimensions_of(axes)
  local list, joint = {}, nil
  for _, axis in ipairs(axes) do
    if not axis.joint then
      list[#list + 1] = { count = #axis.values, axis }
    elseif not joint then
      joint = { count = #axis.values, axis }
      list[#list + 1] = joint
    elseif joint.count ~= #axis.values then
      plan.refuse("%s has %d samples and %s %d: what is sampled is drawn together, so the numbers must be the same",
        joint[1].name, joint.count, axis.name, #axis.values)
    else
      joint[#joint + 1] = axis
    end
  end
  return list
end

local function set_value(case, axis, value)
  case.values[axis.name] = axis.kind == "integrator" and value.label or value
  if axis.kind == "scene" then
    case.values.scene = value:match("([^/]*)$"):gsub("%.lua$", "")
    case.scene = value:sub(1, 1) == "/" and value or case.folder .. "/" .. value
  elseif axis.kind == "param" then case.params[axis.param] = value
  elseif axis.kind == "integrator" then case.method = value
  else case[axis.kind] = value end
end

-- The settings of an integrator override the lists of the sweep; the first value of such a list then represents all its
-- values.
local function apply_method(case, at)
  local method = case.method
  if not method then return true end
  case.integrator = method.text
  for _, key in ipairs { "dt", "tol", "solver" } do
    if method[key] and (at[key] or 1) > 1 then return false end
    case[key] = method[key] or case[key]
    if method[key] then case.values[key] = method[key] end
  end
  return true
end

local function case_at(definition, dimensions, index)
  local case = { folder = definition.folder, params = {}, values = {}, ["until"] = definition["until"],
    accuracy = definition.accuracy, verify = definition.verify, step_limit = definition.step_limit,
    timeout = definition.timeout, threads = definition.threads, trust = definition.trust, seed = definition.seed,
    ["repeat"] = 1 }
  local at = {}
  for d = #dimensions, 1, -1 do
    local k = index % dimensions[d].count + 1
    index = index // dimensions[d].count
    for _, axis in ipairs(dimensions[d]) do
      set_value(case, axis, axis.values[k])
      at[axis.name] = k
    end
  end
  if case.seed then case.seed = case.seed + case["repeat"] - 1 end
  return apply_method(case, at) and case or nil
end

local function expand(definition, axes)
  local dimensions, total = dimensions_of(axes), 1
  for _, d in ipairs(dimensions) do total = total * d.count end
  if total > 1e7 then plan.refuse("%d cases are more than ten million", total) end
  local cases = {}
  for index = 0, total - 1 do
    local case = case_at(definition, dimensions, index)
    if case then
      cases[#cases + 1] = case
      case.number = #cases
    end
  end
  return cases
end

-- ---- checks before the first case ----

local function number_field(definition, name, whole)
  local x = definition[name]
  if x == nil then return end
  if not is_positive(x) and not (name == "seed" and x == 0) or whole and math.type(plain(x)) ~= "integer" then
    plan.refuse("%s: expected a %s, got %s", name, whole and "whole number" or "positive number", tostring(x))
  end
  definition[name] = plain(x)
end

function plan.check(definition)
  check_names("field of a sweep", definition, fields)
  if not definition.scene then plan.refuse("scene: the path of a scene, or a list of paths, is missing") end
  for _, name in ipairs { "until", "accuracy", "timeout" } do number_field(definition, name) end
  for _, name in ipairs { "seed", "step_limit", "jobs", "threads" } do number_field(definition, name, true) end
  for _, id in ipairs(type(definition.paths) == "table" and definition.paths or { definition.paths }) do
    if math.type(id) ~= "integer" or id < 1 then
      plan.refuse("paths: '%s' is not the id of a particle", tostring(id))
    end
  end
  if type(definition.paths) == "number" then definition.paths = { definition.paths } end
  if (definition.jobs or 1) > 256 then plan.refuse("jobs: %d cases at a time are more than 256", definition.jobs) end
  for name in pairs(definition.params or {}) do
    if type(name) ~= "string" then plan.refuse("params: parameters are named, { N = { 16, 32 } }") end
  end
end

local function plugin_names(plugins, kind)
  local names, by_name = {}, {}
  for _, plugin in ipairs(plugins) do
    if plugin.kind == kind then
      names[#names + 1] = plugin.name
      by_name[plugin.name] = plugin
    end
  end
  return names, by_name
end

-- "name:parameter=value,...": checks that the name and the names of its parameters are known.
local function check_method(text, kind, plugins)
  local names, by_name = plugin_names(plugins, kind)
  local name, settings = text:match("^([^:]*):?(.*)$")
  if kind == "solver" and name == "auto" then return end
  local plugin = by_name[name]
  if not plugin then plan.unknown(kind, name, names) end
  local known = {}
  for k, p in ipairs(plugin.params) do known[k] = p.name end
  for key in settings:gmatch("([%w_]+)=") do check_names("parameter of " .. name, { [key] = true }, known) end
end

-- Checks that every value of every axis, with the other axes at their first value, makes a scene. (In a process of its
-- own: a thousand scenes in memory would make each fork of a case slower.)
local function check_scenes(the, path)
  if not the.definition.trust then hooke.confine(path) end
  local seen = {}
  for _, axis in ipairs(the.axes) do
    for _, case in ipairs(the.cases) do
      local mark = axis.name .. "\0" .. tostring(case.values[axis.name]) .. "\0" .. case.scene
      if (axis.kind == "param" or axis.kind == "scene") and not seen[mark] and case.scene == path then
        seen[mark] = true
        local scene, why = hooke.load(case.scene, case.params, { threads = 1, trust = case.trust })
        if not scene then return why end
      end
    end
  end
end

function plan.check_plugins(the, plugins)
  for _, axis in ipairs(the.axes) do
    for _, value in ipairs(axis.values) do
      if axis.kind == "integrator" then
        check_method(value.text, "integrator", plugins)
        if value.solver then check_method(value.solver, "solver", plugins) end
      elseif axis.kind == "solver" then
        check_method(value, "solver", plugins)
      end
    end
  end
  local checked = {}
  for _, case in ipairs(the.cases) do
    local wrong = not checked[case.scene] and child.ask(function() return check_scenes(the, case.scene) end)
    if wrong then plan.refuse("%s", wrong) end
    checked[case.scene] = true
  end
end

-- { definition, axes, cases, varying (the names of the axes with more than one value) }
function plan.make(definition)
  plan.check(definition)
  local the = { definition = definition, axes = axes_of(definition), varying = {}, scale = {} }
  the.cases = expand(definition, the.axes)
  for _, axis in ipairs(the.axes) do
    if #axis.values > 1 then the.varying[#the.varying + 1] = axis.name end
    the.scale[axis.name] = axis.values.scale
  end
  return the
end

return plan
