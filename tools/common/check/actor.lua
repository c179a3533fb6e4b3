-- What the checks of constraints, correctors, sources, solvers, outputs and services share: the scene in which a plugin
-- is tried, values for its parameters, and states.
local inspect = require("inspect")
local actors = require("actors")
local watching = require("watching")
local functions = require("common.check.functions")

local actor = {}

-- ---- the scene ----

actor.POSITIONS = { { 0, 0, 0.1 }, { 1, 0.1, -0.2 }, { 2, -0.1, 0.3 }, { 2.9, 0.2, -0.1 }, { 4, 0, 0.2 }, { 5, 0.3, 0 } }

local function number_for(p)
  local low, high = p.min or -math.huge, p.max or math.huge
  if p.max and p.max <= p.min then high = math.huge end
  local x = 1
  if x > high then x = low > -math.huge and (low + high) / 2 or high - 1 end
  if x < low or (x == low and p.above_min) then x = low + 1 end
  return p.type == "integer" and math.floor(x + 0.5) or x
end

local lists = { particles = { 2, 4, 6 }, edges = { { 1, 2 }, { 2, 3 }, { 4, 5 } }, triangles = { { 1, 2, 3 }, { 4, 5, 6 } },
  tetrahedra = { { 2, 1, 3, 4 }, { 4, 3, 5, 6 } } }

local function value_for(p)
  if lists[p.type] then return lists[p.type] end
  if p.type == "number" or p.type == "integer" or p.type == "per tuple" then return number_for(p) end
  if p.type == "vector" then return { 0.3, -0.7, 0.5 } end
  if p.type == "numbers" then return { number_for(p), number_for(p), number_for(p) } end
  if p.type == "boolean" then return true end
  if p.type == "string" then return "heat" end
  return p.text:match("^[^|]+")
end

local function starts(plugin, values)
  return (pcall(function() return actor.scene(plugin, values):run { to = 0 } end))
end

-- Pictures are small where they may be: nothing that is checked hangs on their size, and large ones take minutes.
local function small_picture(p)
  local pixels = math.max(p.min or 1, math.min(64, p.max or 64))
  return p.initial[1] > pixels and math.floor(pixels) or nil
end

-- What a plugin needs, with or without the lists that it may do without: first those that it starts with. The run that
-- tries that lives as long as the process: it is made once.
local function find_bases(plugin)
  local whole, bare, optional = {}, {}, false
  for _, p in ipairs(plugin.params) do
    local value = plugin.given[p.name]
    if value == nil and p.type == "integer" and p.unit == "pixels" then value = small_picture(p) end
    if value == nil and (p.required or lists[p.type]) then value = value_for(p) end
    whole[p.name] = value
    local left_out = plugin.given[p.name] == nil and p.optional and lists[p.type] ~= nil
    if left_out then optional = true else bare[p.name] = value end
  end
  if not optional then return { whole } end
  return starts(plugin, whole) and { whole, bare } or { bare, whole }
end

local function bases(plugin)
  plugin.bases = plugin.bases or find_bases(plugin)
  return plugin.bases
end

-- The settings in which a plugin is tried: what it needs and every list that may be given; in addition, one at a time,
-- every other choice, the first of its functions (others may have to fit it, as a gradient does), and values for all
-- numbers that are 0 by default; where lists may be left out, all of it without them, too.
function actor.settings(plugin)
  local list, not_zero, first_function = {}, {}, nil
  for _, p in ipairs(plugin.params) do
    if p.type == "function" then first_function = first_function or p end
    local zero = p.initial[1] == 0 and p.initial[2] == 0 and p.initial[3] == 0
    local given = plugin.given[p.name] ~= nil
    if (p.type == "number" or p.type == "vector") and zero and not p.optional and not given then not_zero[p.name] = value_for(p) end
  end
  for k, base in ipairs(bases(plugin)) do
    local suffix = k == 1 and "" or ", other lists"
    local function more(name, changes)
      local values = {}
      for key, value in pairs(base) do values[key] = value end
      for key, value in pairs(changes) do values[key] = value end
      local refused = plugin.refused and plugin.refused[name .. suffix]
      if not refused then list[#list + 1] = { name = name .. suffix, values = values } end
    end
    more("as it is", {})
    for _, p in ipairs(plugin.params) do
      local free = plugin.given[p.name] == nil
      if free and p.type == "boolean" then more(("%s = %s"):format(p.name, p.initial[1] == 0), { [p.name] = p.initial[1] == 0 }) end
      if free and p.type == "choice" then
        local place = 0
        for word in p.text:gmatch("[^|]+") do
          if place ~= p.initial[1] then more(("%s = %s"):format(p.name, word), { [p.name] = word }) end
          place = place + 1
        end
      end
    end
    if first_function and plugin.given[first_function.name] == nil then
      more(first_function.name, { [first_function.name] = functions.made(first_function, 1, plugin.has and plugin.has.speed) })
    end
    if next(not_zero) then more("with no number 0", not_zero) end
  end
  return list
end

local scenes = 0

-- A scene with the plugin. options: integrator, dt, duration, gravity, springs, positions, velocities, masses, threads, without,
-- allocations.
function actor.scene(plugin, values, options)
  options = options or {}
  local scene
  if plugin.scene then
    local why
    scene, why = hooke.load(plugin.scene, {}, { trust = true, threads = options.threads,
      without = options.without and { "checked" } or nil })
    if not scene then error(why, 0) end
    return scene
  end
  scene = hooke.scene { duration = options.duration or 1, fps = 20, integrator = options.integrator or "rk4",
    dt = options.dt or 0.01 }
  scene:channel("heat", { initial = 0.4 })
  local points, masses, velocities = options.positions or actor.POSITIONS, {}, {}
  for i = 1, #points do
    masses[i] = options.masses and options.masses[i] or 0.7 + 0.1 * (i % 5)
    velocities[i] = options.velocities and options.velocities[i]
      or { 0.4 * math.sin(3.3 * i), 0.4 * math.sin(1.9 * i), 0.4 * math.sin(2.7 * i) }
  end
  if #points > 0 then scene:particles { positions = points, velocities = velocities, masses = masses } end
  if options.gravity then scene:force("gravity", {}) end
  if options.springs then scene:force("springs", { edges = lists.edges, k = 50 }) end
  if not options.without then
    local params = { label = plugin.kind ~= "solver" and "checked" or nil }
    for name, value in pairs(values) do params[name] = value end
    scene[plugin.kind](scene, plugin.path, params)
  end
  inspect.threads(scene, options.threads or 1)
  inspect.allocations(scene, options.allocations or 0)
  scenes = scenes + 1
  inspect.folder(scene, ("out/check/%d"):format(scenes)) -- a run has its folder for itself
  return scene
end

-- An error's text without the place in a script.
function actor.plain(why) return (tostring(why):gsub("^%S+%.lua:%d+: ", "")) end

-- Calls body(a, setting, run) with the plugin of a run at its start, in every setting that starts, and returns the names of
-- those whose values it refuses (HK_BAD_PARAM), as keys. That none starts is an error with the reason of the first.
function actor.each(plugin, lines, body, options)
  local taken, reason, refused = 0, nil, {}
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local scene -- lives as long as its run is looked at
    local fine, run = pcall(function()
      scene = actor.scene(plugin, setting.values, options)
      watching.quiet(scene, options and options.quiet)
      return scene:run { to = 0 }
    end)
    if scene then watching.quiet(scene, false) end
    if fine then
      taken = taken + 1
      body(actors.open(run, plugin.kind, options and options.side), setting, run, scene)
    else
      reason = reason or actor.plain(run)
      if inspect.blamed() then refused[setting.name] = true end
    end
  end
  if taken == 0 then error(reason, 0) end
  return refused
end

-- An actor in a run of its own, where services serve it alone; nil: the setting is refused. The second result has to live as
-- long.
function actor.fresh(plugin, setting, options)
  local scene
  local fine, run = pcall(function()
    scene = actor.scene(plugin, setting.values, options)
    return scene:run { to = 0 }
  end)
  if fine then return actors.open(run, plugin.kind), { run, scene } end
end

-- ---- states ----

-- The same numbers for every seed: a linear congruence (Knuth), the upper bits.
function actor.random(seed)
  local state = seed * 7919 + 1
  return function()
    state = (state * 6364136223846793005 + 1442695040888963407)
    return ((state >> 11) & 0x1fffffffffffff) / 0x20000000000000 * 2 - 1
  end
end

function actor.moved(list, random, by)
  local moved = {}
  for k, x in ipairs(list) do moved[k] = x + by * random() end
  return moved
end

function actor.largest(list)
  local most = 0
  for _, x in ipairs(list) do most = (x ~= x or math.abs(x) > most) and math.abs(x) or most end
  return most
end

function actor.finite(list)
  for _, x in ipairs(list) do if x ~= x or math.abs(x) == math.huge then return false end end
  return true
end

function actor.same(a, b)
  if #a ~= #b then return false end
  for k = 1, #a do if a[k] ~= b[k] and (a[k] == a[k] or b[k] == b[k]) then return false end end
  return true
end

-- Degenerate shapes of the state: all at one point, all on a line, all in a plane.
function actor.degenerate(state)
  local at_one, on_line, flat = {}, {}, {}
  for k, x in ipairs(state.x) do
    local c = (k - 1) % 3
    at_one[k], on_line[k], flat[k] = 0.5, c == 0 and x or 0, c < 2 and x or 0
  end
  return { { "coincident", at_one }, { "collinear", on_line }, { "flat", flat } }
end

-- Whether what body() takes from the heap is freed in the end.
function actor.frees(lines, body)
  local before, freed = inspect.heap()
  body()
  collectgarbage()
  collectgarbage()
  local now, freed_now = inspect.heap()
  local left = now - before - (freed_now - freed)
  if left > 0 then
    lines:wrong(("%d of %d blocks of malloc were not freed"):format(left, now - before),
      "free them in `destroy`, or take them from host->allocate")
  end
end

actor.CROWD = 2000 -- particles

-- Many particles about the few that lists name, for loops that are cut and memory that grows.
function actor.crowd()
  local positions, random = {}, actor.random(4)
  for k, x in ipairs(actor.POSITIONS) do positions[k] = x end
  for k = #positions + 1, actor.CROWD do positions[k] = { 6 * random(), 6 * random(), 6 * random() } end
  return positions
end

-- The `try` of a kind's properties: the plugin's calls are named where a process ends, and its heap is counted.
-- `module` is the native one that calls it; left out: actors.
function actor.watched(plugin, report, module)
  inspect.quiet()
  return function(name, body)
    return report:try(name, function(lines)
      inspect.watch(lines.fd, plugin.path);
      (module or actors).watch(lines.fd)
      body(lines)
    end)
  end
end

-- Whether the plugin starts; its flags and further functions are then fields of it, and `refused`: the names of settings
-- that it refuses, as a choice that belongs to a parameter which is left out. They are not tried; what fails otherwise is.
function actor.starts(plugin, try, options)
  local fine, found = try("it starts", function(lines)
    local known
    local refused = actor.each(plugin, lines, function(a)
      local flags, has = actors.flags(a)
      known = known or { flags = flags, has = has }
    end, options)
    known.refused = refused
    lines:value(known)
  end)
  if not fine or not found[1] then return false end
  plugin.flags, plugin.has, plugin.refused = found[1].flags, found[1].has, found[1].refused
  return true
end

return actor
