-- The integrators as methods to compare: each with the one number that controls its accuracy (a step, a tolerance,
-- substeps), and a list of its values from cheap to accurate. Plugins are taken from the catalogue; this file lists
-- only plugins that are several methods, and those whose accuracy is not controlled by the step or the tolerance.
local methods = {}

local variants = {
  arkode = { { settings = "method=erk", order = 5 }, { settings = "method=dirk", order = 5, implicit = true } },
  cvode = { { settings = "method=bdf" }, { settings = "method=adams" } },
  local_global = { { settings = "iterations=10" }, { settings = "iterations=100" } },
  xpbd = { { by = "substeps" }, { settings = "bdf=2", by = "substeps", order = 2 } },
  baraff_witkin = { { by = "dt" } }, -- its steps depend on the stretch, up to a longest step
}

local first_substeps, first_tolerance, last_tolerance = 4, -2, -12

local function text_of(name, settings)
  return settings and name .. ":" .. settings or name
end

local function method_of(plugin, variant, step)
  local by = variant.by or plugin.adaptive and "tol" or "dt"
  local text, implicit = text_of(plugin.name, variant.settings), variant.implicit or plugin.implicit
  return { plugin = plugin.name, label = text, integrator = text, settings = variant.settings, by = by,
    implicit = implicit, adaptive = plugin.adaptive, stages = plugin.stages,
    order = variant.order or plugin.order,
    varies = plugin.name == "cvode", -- it chooses its order itself
    longest = not implicit and step and step.suggestion or math.huge, rows = {} }
end

-- All methods of the catalogue; `steps` are those of hooke.explain.
function methods.all(catalogue, steps)
  local list, step = {}, {}
  for _, s in ipairs(steps) do step[s.name] = s end
  for _, plugin in ipairs(catalogue) do
    if plugin.kind == "integrator" then
      for _, variant in ipairs(variants[plugin.name] or { {} }) do
        list[#list + 1] = method_of(plugin, variant, step[plugin.name])
      end
    end
  end
  return list
end

-- "a,b:x=1,y=2,c" -> { "a", "b:x=1,y=2", "c" }: a comma also separates the parameters of one method.
function methods.split(text)
  local list = {}
  for part in text:gmatch("[^,]+") do
    local last = list[#list]
    if last and last:find(":", 1, true) and part:find("=", 1, true) and not part:find(":", 1, true) then
      list[#list] = last .. "," .. part
    else
      list[#list + 1] = part
    end
  end
  return list
end

-- "a:x=1,y=2@0.01,b" -> two methods, { integrator =, label =, dt = }, the first with a step of its own, s; or nil and why
-- not. No text: none.
function methods.with_steps(text)
  local list = {}
  for k, word in ipairs(text and methods.split(text) or {}) do
    local name, dt = word:match("^(.*)@([^@]*)$")
    list[k] = { label = word, integrator = name or word, dt = tonumber(dt) }
    if name and not (list[k].dt and list[k].dt > 0) then return nil, ("'%s' is not a step in s"):format(dt) end
  end
  return list
end

-- The methods that the user names: a plugin's name means all its variants, "name:parameter=value" this variant only.
function methods.chosen(catalogue, steps, text)
  local all, list, names, by_name = methods.all(catalogue, steps), {}, {}, {}
  for _, plugin in ipairs(catalogue) do
    if plugin.kind == "integrator" then
      names[#names + 1] = plugin.name
      by_name[plugin.name] = plugin
    end
  end
  local step = {}
  for _, s in ipairs(steps) do step[s.name] = s end
  for _, choice in ipairs(methods.split(text)) do
    local name, settings = choice:match("^([^:]+):?(.*)$")
    if not name or not by_name[name] then
      local near = hooke.nearest(name or choice, names)
      return nil, ("there is no integrator '%s'%s"):format(name or choice,
        near and ("; did you mean '%s'?"):format(near) or "; see: hooke plugins")
    end
    if settings == "" then
      for _, method in ipairs(all) do
        if method.plugin == name then list[#list + 1] = method end
      end
    else
      local base = (variants[name] or { {} })[1]
      for _, variant in ipairs(variants[name] or {}) do
        if variant.settings and settings:find(variant.settings, 1, true) then base = variant end
      end
      local by = base.by == "substeps" and settings:find("substeps=", 1, true) and "dt" or base.by
      list[#list + 1] = method_of(by_name[name], { settings = settings, by = by, order = base.order,
        implicit = base.implicit }, step[name])
    end
  end
  return list
end

-- "name=a,b,c": every method of the list with each of these values of a parameter of the scene.
function methods.varied(list, text)
  local name, values = text:match("^([%w_]+)=(.+)$")
  if not name then return nil, ("--vary '%s' is not name=value,value"):format(text) end
  local all = {}
  for value in values:gmatch("[^,]+") do
    for _, method in ipairs(list) do
      local one = { rows = {} }
      for key, of_method in pairs(method) do
        if key ~= "rows" then one[key] = of_method end
      end
      one.label, one.params = ("%s %s=%s"):format(method.label, name, value), { [name] = value }
      all[#all + 1] = one
    end
  end
  return all
end

-- ---- the values from cheap to accurate ----

local function pieces(method, fps)
  local n = math.ceil(1 / (fps * method.longest) * (1 - 1e-12))
  return math.max(n, 1)
end

local function with_substeps(method, count, fps)
  local settings = ("substeps=%d"):format(count)
  if method.settings then settings = method.settings .. "," .. settings end
  return { integrator = text_of(method.plugin, settings), dt = 1 / fps, substeps = count }
end

local function with_steps(method, count, fps) -- of a frame
  return { integrator = method.integrator, dt = 1 / (fps * count) }
end

-- Value k (0, 1, ...) of the list: the options of the run; nil: no further value.
function methods.setting(method, k, fps)
  if method.by == "substeps" then
    return with_substeps(method, first_substeps << k, fps)
  elseif method.by == "tol" then
    if first_tolerance - k < last_tolerance then return nil end
    return { integrator = method.integrator, tol = tonumber(("1e%d"):format(first_tolerance - k)) }
  end
  return with_steps(method, pieces(method, fps) << k, fps)
end

-- The logarithm of what the setting asks for: of 1/step, of the substeps, of 1/tolerance.
function methods.work(setting)
  return math.log(setting.substeps or 1 / (setting.tol or setting.dt))
end

-- The cheapest setting of at least this work, with whole numbers of steps in a frame.
function methods.at_work(method, work, fps)
  if method.by == "tol" then
    return { integrator = method.integrator, tol = math.max(math.exp(-work), 10.0 ^ last_tolerance) }
  end
  local count = math.exp(work) / (method.by == "substeps" and 1 or fps)
  local whole = math.max(math.ceil(count * (1 - 1e-12)), 1)
  return method.by == "substeps" and with_substeps(method, whole, fps) or with_steps(method, whole, fps)
end

-- The approximate time of the next value relative to the last one's.
function methods.growth(method)
  return method.by == "tol" and 10 ^ (1 / math.max(method.order, 1)) or 2
end

function methods.setting_text(setting)
  if setting.substeps then return ("%d substeps"):format(setting.substeps) end
  return setting.tol and ("tol %.2g"):format(setting.tol) or ("dt %.3g s"):format(setting.dt)
end

return methods
