-- The tests of a source (hooke check): births and deaths that the scene can have, failures that are passed on, and
-- numbers that do not hang on the step.
local actors = require("actors")
local actor = require("common.check.actor")
local whole_runs = require("common.check.whole_runs")

local MANY = 100000 -- births in a step, above which nobody can have meant it

local AFTER_STEPS = 1 -- hk_source.flags

local function is_after(a) return actors.flags(a) & AFTER_STEPS ~= 0 end

-- Calls `emit` before `steps` steps of h, or after them by its flag; body(births, deaths, t) looks at each.
local function emissions(a, h, steps, body)
  local after = is_after(a) and 1 or 0
  for k = 0, steps - 1 do
    local t = (k + after) * h
    actors.set(a, { t = t })
    local births, deaths, fine, said = actors.emit(a, h, MANY)
    if not fine then error(("emit failed at t = %g s: %s"):format(t, said), 0) end
    body(births, deaths, t)
  end
end

-- ---- properties ----

local function births_are_whole(plugin, lines)
  actor.each(plugin, lines, function(a)
    local groups = actors.groups(a)
    emissions(a, 0.05, 40, function(births, _, t)
      for k, b in ipairs(births) do
        local where = ("birth %d at t = %g s"):format(k, t)
        if not (b.mass > 0 and b.mass < math.huge) then
          return lines:wrong(("a particle is born with the mass %g kg"):format(b.mass), "masses are above 0", where)
        end
        if not (actor.finite(b.x) and actor.finite(b.v)) then
          return lines:wrong("a particle is born at a place or speed that is no number", "set all of hk_birth", where)
        end
        for _, value in ipairs(b.channels) do
          if math.abs(value) == math.huge then
            return lines:wrong("a particle is born with a channel that is not finite", "NAN stands for the initial value", where)
          end
        end
        if b.age and not (b.age >= 0 and b.age <= 0.05 * (1 + 1e-9)) then
          return lines:wrong(("a particle of the age %g s is born in a step of 0.05 s"):format(b.age),
            "ages are from 0 to h", where)
        end
        if b.lifetime and not (b.lifetime > 0) then -- luacheck: ignore 581
          return lines:wrong(("a particle is born with the lifetime %g s"):format(b.lifetime), "INFINITY: it stays", where)
        end
        if b.group >= math.max(groups, 1) then
          return lines:wrong(("a particle is born into group %d of %d"):format(b.group, groups),
            "group is a position in model->group_name", where)
        end
      end
    end)
  end)
end

local function deaths_are_of_the_living(plugin, lines)
  actor.each(plugin, lines, function(a, _, run)
    local n = run:state().n
    emissions(a, 0.05, 60, function(_, deaths, t)
      for _, index in ipairs(deaths) do
        if index > n then
          return lines:wrong(("it removes particle %d of %d"):format(index, n), "indices are 0 to view->n - 1",
            ("t = %g s"):format(t))
        end
      end
    end)
  end)
end

-- Where the host has no memory for a birth, `emit` fails as well.
local function passes_failures_on(plugin, lines)
  actor.each(plugin, lines, function(a)
    for k = 0, 100 do
      actors.set(a, { t = k * 0.05 })
      local _, _, fine, _, refused = actors.emit(a, 0.05, 0)
      if refused and fine then
        return lines:wrong("a birth that the host refuses is lost without a word",
          "return the status of population->add and population->remove")
      elseif refused then return end
    end
  end)
end

-- The first call at t = 0 may bear more; after that births per second do not hang on h. One more or less is rounding.
local function same_number_for_any_step(plugin, lines)
  local counts = {}
  for _, h in ipairs { 0.1, 0.05, 0.0125 } do
    actor.each(plugin, lines, function(a, setting)
      local count = 0
      emissions(a, h, math.floor(4 / h + 0.5), function(births) count = count + #births end)
      counts[setting.name] = counts[setting.name] or {}
      table.insert(counts[setting.name], count)
    end)
  end
  for name, list in pairs(counts) do
    local least, most = math.min(table.unpack(list)), math.max(table.unpack(list))
    if most - least > 2 + 0.1 * most then
      return lines:wrong(("births in 4 s hang on the step: %d, %d and %d with steps of 0.1, 0.05 and 0.0125 s"):format(
        list[1], list[2], list[3]), "a rate is per second: bear what is due by view->t, or rate times h", name)
    end
  end
end

-- Births as a list of their times and numbers, in the order of their times, in a scene at rest: what is born from moving
-- particles is born where they were.
local function born(a, h, steps)
  local list, rest = {}, {}
  for k = 1, #actors.state(a).v do rest[k] = 0 end
  actors.set(a, { v = rest })
  emissions(a, h, steps, function(births, _, t)
    for _, b in ipairs(births) do
      list[#list + 1] = { t - (b.age or 0), b.mass, b.x[1], b.x[2], b.x[3], b.v[1], b.v[2], b.v[3] }
    end
  end)
  table.sort(list, function(p, q) return p[1] < q[1] end)
  return list
end

-- With ages, births are the same ones for any length of the steps.
local function same_births_for_any_step(plugin, lines)
  local END <const> = 2 -- s; births at that time itself may be in either
  local first = {}
  for _, h in ipairs { 0.1, 0.0125 } do
    actor.each(plugin, lines, function(a, setting)
      if not is_after(a) then return end
      local list = born(a, h, math.floor(END / h + 0.5))
      local other = first[setting.name]
      first[setting.name] = list
      for k = 1, other and math.min(#list, #other) - 3 or 0 do
        for c = 1, 8 do
          if not (math.abs(list[k][c] - other[k][c]) <= 1e-9 * (1 + math.abs(other[k][c]))) then -- luacheck: ignore 581
            return lines:wrong(("birth %d hangs on the step: at %.9g s with steps of 0.1 s, at %.9g s with 0.0125 s"):format(k,
              other[k][1], list[k][1]), "give births the age since they were due, and draw numbers by the number of the birth")
          end
        end
      end
    end)
  end
end

-- Beside another instance, asked in turn with it, it bears what it bears alone.
local function keeps_to_its_instance(plugin, lines)
  actor.each(plugin, lines, function(_, setting)
    local kept = {} -- the runs
    local function fresh()
      local a, run = actor.fresh(plugin, setting)
      kept[#kept + 1] = run
      return a
    end
    local alone, one, other, list = born(fresh(), 0.05, 40), fresh(), fresh(), {}
    local rest = {}
    for k = 1, #actors.state(one).v do rest[k] = 0 end
    actors.set(one, { v = rest })
    local after = is_after(one) and 1 or 0
    for k = 0, 39 do
      local t = (k + after) * 0.05
      for _, a in ipairs { one, other } do
        actors.set(a, { t = a == one and t or 1.7 * t })
        for _, b in ipairs((actors.emit(a, 0.05, MANY))) do
          if a == one then list[#list + 1] = { t - (b.age or 0), b.mass, b.x[1], b.x[2], b.x[3], b.v[1], b.v[2], b.v[3] } end
        end
      end
    end
    table.sort(list, function(p, q) return p[1] < q[1] end)
    local same = #alone == #list
    for k = 1, same and #list or 0 do same = same and actor.same(alone[k], list[k]) end
    if not same then
      lines:wrong(("beside another instance it bears others: %d births alone, %d then"):format(#alone, #list),
        "keep all data in the instance, no static variables; take random numbers from host->random")
    end
  end)
end

local function few_at_a_time(plugin, lines)
  actor.each(plugin, lines, function(a)
    actors.set(a, { t = 1 })
    local _, _, _, _, refused = actors.emit(a, 1e-3, MANY)
    if refused then lines:wrong(("it bears more than %d particles before one step of 1 ms"):format(MANY)) end
  end)
end

local function empty_scene(plugin, lines)
  local options = { positions = {} }
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s, in a scene without particles", setting.name)
    local fine, run = pcall(function() return actor.scene(plugin, setting.values, options):run() end)
    if not fine and not tostring(run):find("particle", 1, true) then
      return lines:wrong("a run without particles at its start fails: " .. actor.plain(run))
    end
  end
end

local function run(plugin, lines)
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local started = false -- a setting that is refused is none
    local fine, ended = pcall(function()
      local scene = actor.scene(plugin, setting.values, { springs = true, duration = 2 })
      scene:run { to = 0 }
      started = true
      return actor.scene(plugin, setting.values, { springs = true, duration = 2 }):run()
    end)
    if not fine and started then return lines:wrong("a run with it fails: " .. actor.plain(ended)) end
    local last = 0
    for _, id in ipairs(started and ended:state():ids() or {}) do
      if id <= last then return lines:wrong("ids do not rise with the index") end
      last = id
    end
  end
end

return function(plugin, report)
  local try = actor.watched(plugin, report)
  if not actor.starts(plugin, try) then return end
  try("births have a mass, a place, a speed and a group", function(l) births_are_whole(plugin, l) end)
  try("deaths are of particles that there are", function(l) deaths_are_of_the_living(plugin, l) end)
  try("a failure of the host is passed on", function(l) passes_failures_on(plugin, l) end)
  try("births do not hang on the step", function(l) same_number_for_any_step(plugin, l) end)
  try("births are those of any step, by their ages", function(l) same_births_for_any_step(plugin, l) end)
  try("it keeps nothing outside its instance", function(l) keeps_to_its_instance(plugin, l) end)
  try("births of a step are bounded", function(l) few_at_a_time(plugin, l) end)
  try("a scene without particles", function(l) empty_scene(plugin, l) end)
  try("a run with it comes to its end", function(l) run(plugin, l) end)
  whole_runs.habits(plugin, try)
end
