-- The tests of a force (hooke check): on a small cloth at random and degenerate states, with every accepted choice of
-- its parameters.
local inspect = require("inspect")

local SEEDS = 3

-- Differences of smooth forces are accurate to 1e-10 at the best step; a wrong term has a relative error of some
-- percent.
local DIFFERENCES = 1e-6
-- The rounding error of sums over some tens of numbers of size 1.
local ROUNDING = 1e-12

-- ---- the scene of a test ----

local function sheet(nx, ny)
  local scene = hooke.scene { duration = 1, integrator = "leapfrog" }
  local cloth = scene:grid { nx = nx, ny = ny, width = nx - 1, height = ny - 1, mass = 0.7 * nx * ny }
  return scene, cloth:structural() .. cloth:shear()
end

-- A positive number inside the limits that differs from usual defaults.
local function number_for(p)
  local low, high = p.min or -math.huge, p.max or math.huge
  local x = 1.3
  if x > high then x = low > -math.huge and (low + high) / 2 or high - 1 end
  if x < low then x = low + 1.3 end
  return x
end

local function value_for(p, edges)
  if p.type == "edges" then return edges end
  if p.type == "number" or p.type == "per tuple" then return number_for(p) end
  if p.type == "integer" then return math.floor(number_for(p) + 0.5) end
  if p.type == "vector" then return { 0.3, -0.7, 0.5 } end
  if p.type == "particles" then return { 1, 3, 6 } end
  if p.type == "boolean" then return true end
  return nil
end

local function is_zero(p) return p.initial[1] == 0 and p.initial[2] == 0 and p.initial[3] == 0 end

-- Settings of the parameters: first the required ones and numbers that are zero by default; then in addition, one at a
-- time, each optional parameter and every other choice.
local function settings_of(plugin)
  local base, more = {}, {}
  for _, p in ipairs(plugin.params) do
    local scalar = p.type == "number" or p.type == "per tuple" or p.type == "vector"
    if plugin.given[p.name] then base[p.name] = plugin.given[p.name]
    elseif p.required or (scalar and is_zero(p) and not p.optional) then base[p.name] = p
    elseif p.optional or p.type == "particles" then more[#more + 1] = { p, p }
    elseif p.type == "boolean" then
      more[#more + 1] = { p, true }
      more[#more + 1] = { p, false }
    elseif p.type == "choice" then
      for word in p.text:gmatch("[^|]+") do more[#more + 1] = { p, word } end
    end
  end
  local list = { { name = "as it is", values = base } }
  for _, extra in ipairs(more) do
    local values = {}
    for name, value in pairs(base) do values[name] = value end
    values[extra[1].name] = extra[2]
    local what = type(extra[2]) == "table" and "" or "=" .. tostring(extra[2])
    list[#list + 1] = { name = extra[1].name .. what, values = values }
  end
  return list
end

-- The run of a sheet with the force, at its start; or nil and the reason of its refusal.
local function run_of(plugin, setting, size, options)
  local scene, edges = sheet(size[1], size[2])
  local params = { label = "checked", only = options and options.only }
  for name, value in pairs(setting.values) do
    if type(value) == "table" then value = value_for(value, edges) end
    params[name] = value
  end
  inspect.threads(scene, options and options.threads or 1)
  local fine, why = pcall(scene.force, scene, plugin.path, params)
  if not fine then return nil, tostring(why) end
  local run
  fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return nil, tostring(run) end
  return run, #edges
end

-- ---- properties ----

-- The largest figure, or any flag that is set, over the seeds.
local function worst_of(run)
  local worst = {}
  for seed = 1, SEEDS do
    for key, value in pairs(inspect.force(run, "random", seed)) do
      if type(value) == "boolean" then
        local good = key == "finite" or key == "fine" or key == "repeats" or key == "pattern" or key == "definite"
        worst[key] = worst[key] == nil and value or good and worst[key] and value
          or not good and (worst[key] or value)
      elseif worst[key] == nil or value > worst[key] or value ~= value then -- NaN is worst
        worst[key] = value
      end
    end
  end
  return worst
end

local function energies(p, f, report)
  if p.energy and not p.power then
    report:most("force is minus the gradient of its energy", f.gradient, DIFFERENCES)
  elseif p.power then
    report:most("its power is that of the force less the gradient of its energy", f.power, DIFFERENCES)
  else
    report:note("it has neither energy nor power: all of F.v counts as work done on the scene")
  end
end

local function jacobians(p, f, report)
  if not p.jacobian then
    if f.moved_by_x or f.moved_by_v then report:note("it has no Jacobian: implicit methods leave it out") end
    return
  end
  report:add(f.pattern, "its pattern names particles of the scene, the same ones twice")
  if not f.pattern then return end
  report:most(("K = -dF/dx (differences over %.0e m)"):format(f.stiffness_step), f.stiffness, DIFFERENCES)
  report:most(("D = -dF/dv (differences over %.0e m/s)"):format(f.damping_step), f.damping, DIFFERENCES)
  if p.symmetric then report:most("K and D are symmetric, as claimed", f.asymmetry, ROUNDING) end
  if p.offers_symmetric then report:most("and when it is asked for", f.wanted_asymmetry, ROUNDING) end
  if p.offers_definite then
    report:add(f.definite, "K and D have no negative eigenvalue when it is asked for", "above -1e-9 of the largest")
  end
end

local function claims(p, f, report)
  if p.momentum then report:most("momentum is kept, as claimed", f.momentum, ROUNDING) end
  if p.angular_momentum then report:most("angular momentum is kept, as claimed", f.angular_momentum, ROUNDING) end
  for _, d in ipairs { { "x", "positions" }, { "v", "velocities" }, { "t", "time" } } do
    if not p["on_" .. d[1]] and f.repeats then -- otherwise F differs in any case
      report:add(not f["moved_by_" .. d[1]], ("it does not depend on %s, as claimed"):format(d[2]))
    end
  end
end

local function habits(f, report)
  report:add(f.finite and f.fine, "finite at random states")
  report:add(f.repeats, "the same twice, with and without its power")
  report:most("it adds to what is there", f.adds, 1e-14 * (1 + 1 / math.max(f.force, 1e-300)))
end

local function degenerate(run, report)
  for _, shape in ipairs { "coincident", "collinear", "flat", "mirrored" } do
    local f = inspect.force(run, shape, 1)
    report:add(f.finite and f.fine, ("finite with %s particles"):format(shape))
  end
end

local function selection(plugin, setting, report)
  local run = run_of(plugin, setting, { 4, 3 }, { only = { 2, 3, 6, 7, 10 } })
  if not run then return report:add(false, "it can act on some particles only (only = ids)") end
  report:most("it leaves particles alone that it does not act on, N", inspect.force(run, "random", 1).astray, 0)
end

local function threads_and_time(plugin, setting, report)
  local large = { 100, 100 }
  local one, edges = run_of(plugin, setting, large, { threads = 1 })
  local two = run_of(plugin, setting, large, { threads = 2 })
  report:add(inspect.bytes(one, 1) == inspect.bytes(two, 1), "the same bits with 1 and 2 threads")
  local has_edges = false
  for _, p in ipairs(plugin.params) do has_edges = has_edges or p.type == "edges" end
  local count = has_edges and edges or large[1] * large[2]
  report:note(("%.3g ns per %s"):format(1e9 * inspect.seconds(one) / count, has_edges and "edge" or "particle"))
end

-- ---- values out of range ----

local function outside(p)
  local list = {}
  if not p.min then return list end
  if p.above_min then list[1] = p.min
  elseif p.min > -math.huge then list[1] = p.min - 1 - math.abs(p.min) end
  if p.max < math.huge then list[#list + 1] = p.max + 1 + math.abs(p.max) end
  return list
end

local function refusals(plugin, setting, report)
  local numeric = { number = true, integer = true, ["per tuple"] = true }
  for _, p in ipairs(plugin.params) do
    for _, value in ipairs(numeric[p.type] and outside(p) or {}) do
      local changed = { values = {} }
      for name, v in pairs(setting.values) do changed.values[name] = v end
      changed.values[p.name] = value
      local run, why = run_of(plugin, changed, { 4, 3 })
      report:add(not run and why:find(p.name, 1, true), ("%s = %g is refused, by name"):format(p.name, value))
    end
  end
end

-- Checks the force that hooke.describe described; `path` and `given` are also fields of it.
local function check(plugin, report)
  local first, refused
  for _, setting in ipairs(settings_of(plugin)) do
    local run, why = run_of(plugin, setting, { 4, 3 })
    if run then
      first = first or setting
      report:at(setting.name)
      local f = worst_of(run)
      habits(f, report)
      energies(plugin, f, report)
      jacobians(plugin, f, report)
      claims(plugin, f, report)
      degenerate(run, report)
    else
      refused = refused or why
    end
  end
  if not first then return report:add(false, "it takes its parameters: give some with name=value", refused) end
  report:at("in a scene")
  selection(plugin, first, report)
  threads_and_time(plugin, first, report)
  refusals(plugin, first, report)
end

return function(plugin, report)
  require("inspect").quiet()
  report:try("its properties", function(lines) check(plugin, lines) end)
end
