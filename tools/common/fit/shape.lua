-- A still shape as data: a table of comma-separated values with a line for each particle, that is fitted as a whole, at a time of the run
-- or at rest. Its columns are `particle` (an id, or the name of a group that is one particle; without it the lines are the particles
-- of the scene, in the order of their ids), some of x, y, z (m), and standard deviations, x_sd, y_sd, z_sd or one `sd` for all. Empty cells
-- are gaps. The table that --state writes is one as well: `id` stands for `particle`, and vx, vy, vz and mass are passed over.
local case_process = require("common.run.case_process")
local data = require("common.fit.data")
local units = require("common.run.units")

local shape = {}

local axes = { "x", "y", "z" }
local meant = { particle = "particle", id = "particle", x = "x", y = "y", z = "z", sd = "sd", x_sd = "x_sd", y_sd = "y_sd", z_sd = "z_sd" }
local passed_over = { vx = true, vy = true, vz = true, mass = true }

-- ---- the scene's particles ----

local function execute(case)
  local scene, refused = hooke.load(case.scene, case.params, { integrator = case.integrator, seed = case.seed, trust = case.trust,
    threads = 1, output = false })
  if not scene then return { failed = refused } end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return { failed = tostring(run) } end
  return { ids = run:state():ids(), named = require("resting").groups(run) }
end

-- { ids (list), named ({ group = id of its one particle, or false }) } at the start, or { failed }.
function shape.particles(case)
  case.execute = execute
  return case_process.run(case)
end

-- ---- the table ----

-- What each column holds, by its name in `meant` or false; or nil and what is wrong.
local function columns_of(cells)
  local columns, found, known = {}, {}, {}
  for name in pairs(meant) do known[#known + 1] = name end
  table.sort(known)
  for k, cell in ipairs(cells) do
    local name, unit = units.of_heading(cell)
    if unit and unit ~= "m" then return nil, ("the column '%s' is in %s, and a shape is in m: convert it"):format(cell, unit) end
    if unit then cell = name end
    columns[k] = meant[cell] or false
    if not columns[k] and not passed_over[cell] then
      local near = hooke.nearest(cell, known)
      return nil, ("the column '%s' is none of a shape%s: it has particle, x, y, z, sd, x_sd, y_sd and z_sd"):format(cell,
        near and ("; did you mean '%s'?"):format(near) or "")
    end
    if found[columns[k] or cell] then return nil, ("the column '%s' is there twice"):format(cell) end
    found[columns[k] or cell] = true
  end
  if not (found.x or found.y or found.z) then return nil, "there is no column x, y or z, where particles are, m" end
  for _, axis in ipairs(axes) do
    if found[axis .. "_sd"] and not found[axis] then return nil, ("'%s_sd' is there, '%s' is not"):format(axis, axis) end
    if found[axis .. "_sd"] and found.sd then return nil, ("'sd' and '%s_sd' say the same: leave one out"):format(axis) end
  end
  return columns, found
end

-- The particle of a line, by its cell or, where there is no such column, as the next one; or nil and what is wrong.
local function particle_of(cell, known, line)
  local count = #known.ids
  if not cell then return known.ids[line] end -- too many are found at the end
  local id = math.tointeger(tonumber(cell))
  if id and known.by_id[id] then return id end
  if id then
    return nil, ("there is no particle %d: the scene has %d, %d to %d"):format(id, count, known.ids[1] or 0, known.ids[count] or 0)
  end
  if known.named[cell] then return known.named[cell] end
  if known.named[cell] == false then return nil, ("the group '%s' has several particles: give their ids"):format(cell) end
  local names = {}
  for name in pairs(known.named) do names[#names + 1] = name end
  local near = hooke.nearest(cell, names)
  return nil, ("'%s' is neither the id of a particle nor a group of one%s"):format(cell,
    near and ("; did you mean '%s'?"):format(near) or "")
end

-- The numbers of a line by their columns; or nil and what is wrong.
local function numbers_of(cells, columns)
  local value = {}
  for k, cell in ipairs(cells) do
    local name = columns[k]
    if name == "particle" then value.particle = cell
    elseif name then
      local x, wrong = data.number(name, cell)
      if x == false then return nil, wrong end
      if x and name:find("sd$") and x <= 0 then
        return nil, ("%s: '%s' is not positive: give a standard deviation, or leave the column out"):format(name, cell)
      end
      value[name] = x
    end
  end
  return value
end

-- Adds the observations of a line; or nil and what is wrong.
local function add_line(state, cells, number)
  local fine, wrong = data.fills(cells, state.columns)
  if not fine then return nil, wrong end
  local value, id
  value, wrong = numbers_of(cells, state.columns)
  if not value then return nil, wrong end
  state.lines = state.lines + 1
  id, wrong = particle_of(state.found.particle and value.particle, state.known, state.lines)
  if wrong then return nil, wrong end
  if id and state.seen[id] then return nil, ("particle %d is there twice (line %d)"):format(id, state.seen[id]) end
  if id then state.seen[id] = number end
  for c, axis in ipairs(axes) do
    if value[axis] then
      state.list[#state.list + 1] = { t = state.at, name = axis, particle = id, axis = c, value = value[axis],
        sd = value[axis .. "_sd"] or value.sd, line = number }
    end
  end
  return true
end

-- known: of shape.particles(); at: s, the time of the shape, 0 at rest. Returns the observations { t, name (its axis), particle, axis,
-- value, sd, line }, or nil and a sentence that begins with the file.
function shape.read(path, known, at)
  local state = { known = { ids = known.ids, named = known.named, by_id = {} }, at = at, list = {}, seen = {}, lines = 0 }
  for _, id in ipairs(known.ids) do state.known.by_id[id] = true end
  local fine, why = data.lines(path, function(cells)
    state.columns, state.found = columns_of(cells)
    return state.columns, state.found
  end, function(cells, number) return add_line(state, cells, number) end)
  if not fine then return nil, why end
  if not (state.found and state.found.particle) and state.lines ~= #known.ids then
    return nil, ("%s: %d lines of particles, and the scene has %d: give each a line, or name those that are there in a column "
      .. "'particle'"):format(path, state.lines, #known.ids)
  end
  if #state.list == 0 then return nil, ("%s: there is no number of a place in it"):format(path) end
  return state.list
end

-- ---- in the process of a case: the places of a run ----

-- Adds the numbers of the observations in the run's state; or nil and what is wrong.
local function places(run, observations)
  local state, values, here = run:state(), {}, {}
  for _, id in ipairs(state:ids()) do here[id] = true end
  for k, o in ipairs(observations) do
    if not here[o.particle] then return nil, ("there is no particle %d any more at t = %.9g s"):format(o.particle, state.t) end
    values[k] = ("%.17g"):format(state:position(o.particle)[o.axis])
  end
  return values
end

local balance = 1e-12 -- of the largest force at the start: differences by parameters are of 1e-5 of these

-- At rest: no time passes, and no step is taken.
function shape.at_rest(case)
  local scene, refused = hooke.load(case.scene, case.params, { integrator = "backward_euler", accuracy = 0, seed = case.seed, threads = 1,
    trust = case.trust, output = false })
  if not scene then return { failed = refused } end
  local fine, run = pcall(scene.run, scene, { to = 0 })
  if not fine then return { failed = tostring(run) } end
  local found, values
  found, refused = require("resting").find(run, balance)
  if not found then return { failed = refused } end
  if not found.balanced then
    return { failed = ("it has no equilibrium that is found: %.3g N are left on particle %d (hooke rest)"):format(found.residual,
      found.id) }
  end
  values, refused = places(run, case.observations)
  if not values then return { failed = refused } end
  return { values = values, dt = "0", unstable = found.asked and not found.returned or nil }
end

function shape.at_time(run, case) return places(run, case.observations) end

return shape
