-- The scenes in which a force is tried, and the values of its parameters. A case is a scene with a setting of the
-- parameters; cases.each opens each case that the plugin accepts, and hands out its subject.
local inspect = require("inspect")
local members = require("members")
local functions = require("common.check.functions")

local cases = {}

-- ---- shapes: plain tables { name, length, positions, edges, triangles, tetrahedra } ----
-- `length` is the distance over which a shape's forces change: states are displaced by 0.3 of it.

-- Whether the edges from the first corner of a tetrahedron to the others are right-handed.
local function is_right_handed(positions, corners)
  local d = {}
  for m = 2, 4 do
    d[m] = {}
    for c = 1, 3 do d[m][c] = positions[corners[m]][c] - positions[corners[1]][c] end
  end
  local a, b, e = d[2], d[3], d[4]
  return a[1] * (b[2] * e[3] - b[3] * e[2]) + a[2] * (b[3] * e[1] - b[1] * e[3]) + a[3] * (b[1] * e[2] - b[2] * e[1]) > 0
end

-- Tetrahedra that are not inside out: solids may refuse others.
local function add_tetrahedron(shape, a, b, c, d)
  local right = is_right_handed(shape.positions, { a, b, c, d })
  shape.tetrahedra[#shape.tetrahedra + 1] = right and { a, b, c, d } or { b, a, c, d }
end

local function chain(count)
  local shape = { name = ("chain of %d"):format(count), length = 1, positions = {}, edges = {}, triangles = {},
    tetrahedra = {} }
  for i = 1, count do
    shape.positions[i] = { i, 0.2 * math.sin(2.1 * i), 0.3 * math.cos(1.7 * i) }
    if i > 1 then shape.edges[i - 1] = { i - 1, i } end
    if i > 2 then shape.triangles[i - 2] = { i - 2, i - 1, i } end
    if i > 3 then add_tetrahedron(shape, i - 3, i - 2, i - 1, i) end
  end
  return shape
end

-- A wavy closed loop, each edge from the end of the one before.
local function ring(count)
  local shape = chain(count)
  shape.name = ("ring of %d"):format(count)
  for i = 1, count do
    local angle = 2 * math.pi * i / count
    local radius = count / (2 * math.pi) * (1 + 0.1 * math.sin(3 * angle))
    shape.positions[i] = { radius * math.cos(angle), radius * math.sin(angle), 0.2 * math.sin(2.1 * i) }
  end
  shape.edges[count] = { count, 1 }
  return shape
end

-- Points of a sequence that fills the cube evenly (the additive recurrence of the plastic number), all joined with those
-- that follow next.
local function cloud(count, size)
  local shape = { name = ("cloud of %d in %g m"):format(count, size), length = size / 2, positions = {}, edges = {},
    triangles = {}, tetrahedra = {} }
  for i = 1, count do
    shape.positions[i] = { size * (0.8191725 * i % 1), size * (0.6710436 * i % 1), size * (0.5497005 * i % 1) }
    for k = math.max(1, i - 3), i - 1 do shape.edges[#shape.edges + 1] = { k, i } end
    if i > 2 then shape.triangles[i - 2] = { i, i - 2, i - 1 } end
    if i > 3 then add_tetrahedron(shape, i, i - 3, i - 1, i - 2) end
  end
  return shape
end

local function pair(distance)
  return { name = ("pair %g m apart"):format(distance), length = distance, edges = { { 1, 2 } }, triangles = {},
    tetrahedra = {}, positions = { { 0.3, 0.2, -0.1 }, { 0.3 + 0.8 * distance, 0.2 - 0.36 * distance,
      -0.1 + 0.48 * distance } } }
end

local function sheet(nx, ny)
  local shape = { name = ("sheet of %d x %d"):format(nx, ny), length = 1, grid = { nx, ny }, positions = {}, edges = {},
    triangles = {}, tetrahedra = {} }
  local function at(i, j) return (j - 1) * nx + i end
  local function join(list, ...) list[#list + 1] = { ... } end
  for j = 1, ny do
    for i = 1, nx do
      shape.positions[at(i, j)] = { i - 1, j - 1, 0 }
      if i < nx then join(shape.edges, at(i, j), at(i + 1, j)) end
      if j < ny then join(shape.edges, at(i, j), at(i, j + 1)) end
      if i < nx and j < ny then
        join(shape.edges, at(i, j), at(i + 1, j + 1))
        join(shape.edges, at(i + 1, j), at(i, j + 1))
        join(shape.triangles, at(i, j), at(i + 1, j), at(i + 1, j + 1))
        join(shape.triangles, at(i, j), at(i + 1, j + 1), at(i, j + 1))
        join(shape.tetrahedra, at(i, j), at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)) -- two triangles on a hinge
      end
    end
  end
  return shape
end

-- The first two that a plugin takes are those in which every setting is tried; the pairs have no need of the other
-- properties.
cases.shapes = { sheet(4, 3), cloud(8, 2.2), chain(8), ring(7), cloud(6, 0.2) }
local FIRST = 4 -- the shapes among which these two are
for _, distance in ipairs { 0.001, 0.03, 0.3, 0.9, 1, 1.1, 1.5, 2.5, 10, 100 } do
  cases.shapes[#cases.shapes + 1] = pair(distance)
end
cases.chain, cases.cloud, cases.sheet, cases.pair = chain, cloud, sheet, pair

-- The particles of `only` where a force shall act on some: there are tuples of all kinds among them, and others.
cases.some = { 1, 2, 3, 5, 6, 7 }

-- ---- values of parameters ----

-- A positive number inside the limits that differs from usual defaults.
local function number_for(p, factor)
  local low, high = p.min or -math.huge, p.max or math.huge
  local x = 1.3 * (factor or 1)
  if x > high then x = low > -math.huge and low + (high - low) * 0.5 / (factor or 1) or high - 1 end
  if x < low then x = low + 1.3 * (factor or 1) end
  return p.type == "integer" and math.floor(x + 0.5) or x
end

local function tuples_of(p, shape)
  if p.type == "edges" or p.type == "triangles" or p.type == "tetrahedra" then return shape[p.type] end
  local list = {}
  for i = 1, #shape.positions, 2 do list[#list + 1] = i end
  return shape.particles or list -- every other one
end

-- The list of tuples that a "per tuple" parameter belongs to.
local function list_of(plugin, p)
  for _, q in ipairs(plugin.params) do
    local tuples = q.type == "edges" or q.type == "triangles" or q.type == "tetrahedra" or q.type == "particles"
    if tuples and (p.text == nil or p.text == q.name) then return q end
  end
end

local function value_for(plugin, p, shape, setting)
  local factor = setting.factor or 1
  if p.type == "function" then return functions.made(p, factor) end
  if p.type == "number" or p.type == "integer" then return number_for(p, factor) end
  if p.type == "vector" then return { 0.3 * factor, -0.7, 0.5 } end
  if p.type == "numbers" then return { number_for(p, factor), number_for(p, 0.7 * factor), number_for(p, 1.2 * factor) } end
  if p.type == "boolean" then return true end
  if p.type == "string" then return "heat" end -- the channel that every scene has
  if p.type == "choice" then return p.text:match("^[^|]+") end
  if p.type ~= "per tuple" then return tuples_of(p, shape) end
  local list = setting.each and list_of(plugin, p)
  if not list then return number_for(p, factor) end
  local values = {}
  for k = 1, #tuples_of(list, shape) do values[k] = number_for(p, factor * (1 + 0.1 * (k % 4))) end
  return values
end

local function is_zero(p) return p.initial[1] == 0 and p.initial[2] == 0 and p.initial[3] == 0 end

local NEGLIGIBLE = 1e-9 -- part of its errors that a force keeps where differences of it are taken
local MADE = {} -- a value that is made for the scene

-- Settings of the parameters: first the required ones and numbers that are zero by default; then in addition, one at a
-- time, each optional parameter and every other choice; and one number per tuple.
local function settings_of(plugin)
  local base, more, per_tuple, first = {}, {}, false, nil
  for _, p in ipairs(plugin.params) do
    if p.type == "function" and not first then first = p.name end -- the others are instead of it
    local scalar = p.type == "number" or p.type == "per tuple" or p.type == "vector"
    per_tuple = per_tuple or p.type == "per tuple"
    if plugin.given[p.name] ~= nil then base[p.name] = plugin.given[p.name]
    elseif p.required or p.name == first or (scalar and is_zero(p) and not p.optional) then base[p.name] = MADE
    elseif p.type == "boolean" then
      more[#more + 1] = { p.name, true }
      more[#more + 1] = { p.name, false }
    elseif p.type == "choice" then
      for word in p.text:gmatch("[^|]+") do more[#more + 1] = { p.name, word } end
    else
      more[#more + 1] = { p.name, MADE, instead = p.type == "function" and first or nil }
      if p.type == "number" and (p.min or -1) < 0 then more[#more + 1] = { p.name, math.max(p.min or -2, -2) } end
    end
  end
  local list = { { name = "", values = base } }
  for _, extra in ipairs(more) do
    local values = {}
    for name, value in pairs(base) do values[name] = value end
    if extra.instead then values[extra.instead] = nil end
    values[extra[1]] = extra[2]
    list[#list + 1] = { name = extra[2] == MADE and extra[1] or ("%s = %s"):format(extra[1], extra[2]), values = values }
  end
  if per_tuple then list[#list + 1] = { name = "one number per tuple", values = base, each = true } end
  return list
end

-- ---- a case in a run ----

local function particles_of(scene, shape)
  local count, masses, velocities = #shape.positions, {}, {}
  for i = 1, count do
    masses[i] = shape.masses and shape.masses[i] or 0.7 + 0.1 * (i % 5)
    velocities[i] = { 0.2 * math.sin(3.3 * i), 0.2 * math.sin(1.9 * i), 0.2 * math.sin(2.7 * i) }
  end
  if shape.grid then
    local nx, ny = shape.grid[1], shape.grid[2]
    scene:grid { nx = nx, ny = ny, width = nx - 1, height = ny - 1, mass = 0.7 * nx * ny }
  else
    scene:particles { positions = shape.positions, velocities = velocities, masses = masses }
  end
end

-- The run of a case at its start; or nil and the reason of its refusal. options: threads, only, allocations,
-- integrator (which chooses its steps), to, box (m: the length of a cube that repeats).
function cases.open(plugin, case, options)
  options = options or {}
  local scene
  if case.file then
    local why
    scene, why = hooke.load(case.file, {}, { trust = true, threads = options.threads })
    if not scene then return nil, why end
  else
    scene = hooke.scene { duration = 1, integrator = options.integrator or "leapfrog", dt = not options.integrator and 0.01
      or nil }
    scene:channel("heat", { initial = 0.4 })
    scene:channel("radius", { initial = 0.3 }) -- the channel by which forces know a size
    particles_of(scene, case.shape)
    if options.box then scene:periodic { high = { options.box, options.box, options.box } } end
    local params = { label = "checked", only = options.only }
    for name, value in pairs(case.setting.values) do
      if value == MADE then
        for _, p in ipairs(plugin.params) do
          if p.name == name then value = value_for(plugin, p, case.shape, case.setting) end
        end
      end
      params[name] = value
    end
    local fine, why = pcall(scene.force, scene, plugin.path, params)
    if not fine then return nil, tostring(why) end
  end
  inspect.threads(scene, options.threads or 1)
  inspect.allocations(scene, options.allocations or 0)
  local fine, run = pcall(scene.run, scene, { to = options.to or 0 })
  if not fine then
    local why = tostring(run)
    return nil, why:find("%S") and why or "one of its functions fails and does not say why (host->fail)"
  end
  return run
end

local function name_of(shape, setting)
  return setting.name == "" and shape.name or ("%s, %s"):format(shape.name, setting.name)
end

-- The settings that a scene took, where that is known.
local function accepted_settings(plugin)
  local list = {}
  for _, setting in ipairs(settings_of(plugin)) do
    local taken = not plugin.accepted
    for _, shape in ipairs(cases.shapes) do taken = taken or plugin.accepted[name_of(shape, setting)] end
    if taken then list[#list + 1] = setting end
  end
  return list
end

-- All cases: every shape with the first setting, and the first two that are taken with every one. plugin.accepted, a
-- set of names, leaves out the others.
function cases.list(plugin)
  local list, settings, taken = {}, accepted_settings(plugin), 0
  if plugin.scene then list[1] = { name = plugin.scene, file = plugin.scene, length = 1, few = true } end
  for k, shape in ipairs(cases.shapes) do
    if plugin.accepted and settings[1] and plugin.accepted[name_of(shape, settings[1])] then taken = taken + 1 end
    local all = k <= FIRST and taken <= 2
    for q, setting in ipairs(settings) do
      if (all or q == 1) and (not plugin.accepted or plugin.accepted[name_of(shape, setting)]) then
        list[#list + 1] = { name = name_of(shape, setting), shape = shape, setting = setting, length = shape.length,
          base = q == 1, few = #shape.positions > 2 }
      end
    end
  end
  return list
end

-- A case like this one with another shape. With a plugin, its numbers are others as well, those by default, too.
function cases.variant(case, shape, plugin)
  local setting = { name = case.setting.name, values = case.setting.values, each = case.setting.each,
    factor = plugin and 1.7 }
  if plugin then
    setting.values = {}
    for _, p in ipairs(plugin.params) do
      if p.type == "number" and not p.optional then setting.values[p.name] = MADE end
    end
    for name, value in pairs(case.setting.values) do setting.values[name] = value end
  end
  return { name = name_of(shape, setting), shape = shape, setting = setting, length = shape.length, few = true }
end

-- Calls body(subject, case, run) for every accepted case for which wanted(case) is true (nil: all). Raises an error when
-- there is none, with the reason of the first refusal. options: those of cases.open; side; destroy: the run ends with the
-- body; exact: a force that is not computed to rounding (approximation/1) is made to.
function cases.each(plugin, lines, wanted, body, options)
  local tried, refused = 0, nil
  for _, case in ipairs(cases.list(plugin)) do
    if not wanted or wanted(case) then
      lines:at(case.name)
      local run, why = cases.open(plugin, case, options)
      if run then
        tried = tried + 1
        collectgarbage() -- the subjects before, with their arrays
        local subject = inspect.open(run, plugin.name, options and options.side)
        if options and options.exact then inspect.sharpen(subject, NEGLIGIBLE) end
        case.limits = plugin.has and plugin.has.step_limit
        if not (case.limits and inspect.energy(subject) == math.huge) then body(subject, case, run) end
        if options and options.destroy then inspect.destroy(run) end -- else with the script, which is never
      elseif case.file then error(("--scene %s: %s"):format(case.file, why), 0)
      else refused = refused or why end
    end
  end
  if tried == 0 and refused then error(refused, 0) end
  return tried
end

-- ---- states ----

-- Pseudorandom numbers in [-1, 1], the same ones on every machine.
local function noise(k, seed) return 2 * ((math.sin(12.9898 * k + 78.233 * seed) * 43758.5453) % 1) - 1 end

-- A random state around the case's own: displaced by 0.3 of its length, moving at about 1 m/s. Where the force limits
-- moves, so that some states are never reached, by as much as has a finite energy.
function cases.random_state(subject, case, seed)
  local start = case.start or inspect.state(subject)
  case.start = start
  local x, v, y = {}, {}, {}
  for k = 1, #start.x do v[k] = noise(k + 1000, seed) end
  for k = 1, #start.y do y[k] = 0.5 + 0.3 * noise(k + 2000, seed) end
  for _, part in ipairs(case.limits and { 0.3, 0.1, 0.03, 0.01, 0 } or { 0.3 }) do
    for k = 1, #start.x do x[k] = start.x[k] + part * case.length * noise(k, seed) end
    inspect.set(subject, { x = x, v = v, y = y, t = start.t })
    if case.limits then members.update(subject, x) end
    if not case.limits or inspect.energy(subject) < math.huge then break end
  end
  return x, v
end

return cases
