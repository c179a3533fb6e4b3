-- The tests of a corrector (hooke check): what it says of its changes, what it leaves alone, and the energy that it
-- reports.
local actors = require("actors")
local actor = require("common.check.actor")
local population = require("common.check.population")
local whole_runs = require("common.check.whole_runs")

local WANTS_BEFORE, REPORTS_WORK, MAY_REJECT = 1, 2, 4 -- hk_corrector.flags
local H = 0.01 -- s, the step that has been taken

-- Positions before and after a step with large moves, some below and some above everything.
local function states(a, body)
  local start = actors.state(a)
  for seed = 1, 6 do
    local random = actor.random(seed)
    local reach = seed == 1 and 0 or 0.3 * 2 ^ seed
    local x, v = actor.moved(start.x, random, reach), actor.moved(start.v, random, reach)
    actors.set(a, { t = 0.37, x = x, v = v })
    body(x, v, start, seed)
  end
end

-- `before`: positions and velocities before the step.
local function correct(a, before)
  local c, fine, said = actors.correct(a, H, before.x, before.v)
  if not fine then error(("correct failed: %s"):format(said), 0) end
  return c
end

-- ---- properties ----

-- Of a state that is corrected already, nothing is left to change.
local function says_what_it_changed(plugin, lines)
  actor.each(plugin, lines, function(a)
    local function try(x, v, start)
      local c = correct(a, start)
      local moved = not (actor.same(c.x, x) and actor.same(c.v, v))
      if moved and not c.changed then
        lines:wrong("it changes x or v and does not say so", "set c->changed: integrators keep a history otherwise")
      elseif c.changed and not moved then
        lines:wrong("it says that it changed x or v and did not", "set c->changed only then: every change voids the"
          .. " integrator's history")
      end
      return c
    end
    states(a, function(x, v, start)
      local c = try(x, v, start)
      actors.set(a, { x = c.x, v = c.v })
      try(c.x, c.v, start)
    end)
  end)
end

local function stays_finite(plugin, lines)
  actor.each(plugin, lines, function(a)
    local start = actors.state(a)
    local shapes = actor.degenerate(start)
    shapes[#shapes + 1] = { "randomly placed", actor.moved(start.x, actor.random(9), 3) }
    for _, shape in ipairs(shapes) do
      actors.set(a, { x = shape[2] })
      local c = correct(a, start)
      if not (actor.finite(c.x) and actor.finite(c.v)) then
        return lines:wrong(("not finite with %s particles"):format(shape[1]), "a distance may be 0: divide by none")
      end
    end
  end)
end

-- Twice from the same state: fields of the instance may have changed between, so two instances are asked.
local function repeats(plugin, lines)
  for _, side in ipairs { "behind", "before" } do -- of the arrays' walls
    local first = {}
    for round = 1, 2 do
      actor.each(plugin, lines, function(a, setting)
        states(a, function(_, _, start, seed)
          local c, key = correct(a, start), setting.name .. seed
          if round == 1 then first[key] = c
          elseif not (actor.same(c.x, first[key].x) and actor.same(c.v, first[key].v)) then
            lines:wrong("two instances give different states", "it depends on the view and its own fields alone")
          end
        end)
      end, { side = side })
    end
  end
end

local function repairs(plugin, lines)
  actor.each(plugin, lines, function(a)
    states(a, function(_, _, start)
      local before = actors.violation(a)
      local c = correct(a, start)
      actors.set(a, { x = c.x, v = c.v })
      local after = actors.violation(a)
      if before ~= before or after ~= after or before < 0 or after < 0 then
        return lines:wrong("`violation` is negative or no number")
      end
      if not c.reject and after > before * (1 + 1e-12) then
        lines:wrong(("`correct` makes the violation larger: %.3g m after %.3g m"):format(after, before))
      end
      if not c.changed and not c.reject and before > 1e-9 then
        lines:wrong(("a violation of %.3g m is left as it is"):format(before),
          "`correct` and `violation` have to mean the same")
      end
    end)
  end)
end

-- In a scene whose only energy is that of the motion, so that nothing but the corrector changes a velocity: work is its
-- change.
local function reports_work(plugin, lines)
  local worst = 0
  actor.each(plugin, lines, function(a)
    states(a, function(x, v, start)
      local from = {}
      for k = 1, #x do from[k] = x[k] - H * v[k] end
      local c, change, size = correct(a, { x = from, v = v }), 0, 0
      for k = 1, #v do
        local m = start.mass[(k + 2) // 3] / 2
        change = change + m * (c.v[k] ^ 2 - v[k] ^ 2)
        size = size + m * (c.v[k] ^ 2 + v[k] ^ 2)
      end
      if not c.reject then worst = math.max(worst, math.abs(c.work - change) / math.max(size, 1e-300)) end
    end)
  end)
  lines:most("its work is the change of the kinetic energy, where there is no other", worst, 1e-12,
    "c->work is the change of the scene's energy by the correction, in J")
end

-- A setting that it refuses at the start is not tried.
local function falls(plugin, lines)
  for _, setting in ipairs(actor.settings(plugin)) do
    local function run(to)
      return pcall(function()
        return actor.scene(plugin, setting.values, { gravity = true, duration = 2 }):run(to)
      end)
    end
    lines:at("%s, in a scene with gravity", setting.name)
    if run { to = 0 } then
      local fine, whole = run()
      if not fine then return lines:wrong("a run with it fails: " .. actor.plain(whole)) end
      if whole:summary().verdict == "diverged" then return lines:wrong("a run with it diverges") end
    end
  end
end

local function keeps_to_its_flags(plugin, lines)
  actor.each(plugin, lines, function(a)
    states(a, function(_, _, start)
      local c = correct(a, start)
      if c.reject and plugin.flags & MAY_REJECT == 0 then
        lines:wrong("it takes a step back without HK_MAY_REJECT: the host does not look", "add the flag")
      end
      if c.work ~= c.work or math.abs(c.work) == math.huge then lines:wrong(("its work is %g J"):format(c.work)) end
      if c.reject and not (c.part >= 0 and c.part < 1) then
        lines:wrong(("it asks for a step of %g of the length"):format(c.part), "c->part is above 0 and below 1, or 0: halves")
      end
      if c.work ~= 0 and plugin.flags & REPORTS_WORK == 0 then
        lines:wrong("it reports work without HK_REPORTS_WORK: the host does not look", "add the flag")
      end
    end)
  end)
end

-- All that a correction says, as one list.
local function said(c)
  local list = { c.work, c.changed and 1 or 0, c.reject and 1 or 0 }
  for k = 1, #c.x do list[#list + 1] = c.x[k] end
  for k = 1, #c.v do list[#list + 1] = c.v[k] end
  return list
end

-- What a fresh instance does from state to state, alone and in turn with another one in other states.
local function keeps_to_its_instance(plugin, lines)
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s, beside another instance", setting.name)
    local alone, first = actor.fresh(plugin, setting)
    local list, k, told = {}, 0, false
    if alone then states(alone, function(_, _, start) list[#list + 1] = said(correct(alone, start)) end) end
    local one, second = actor.fresh(plugin, setting)
    local other, third = actor.fresh(plugin, setting)
    if one and other then
      states(one, function(x, v, start)
        k = k + 1
        actors.set(other, { x = actor.moved(x, actor.random(k + 50), 1), v = v, t = 0.2 })
        correct(other, start)
        if not told and not actor.same(list[k], said(correct(one, start))) then
          told = true
          lines:wrong("beside another instance it corrects otherwise", "keep all data in the instance, no static variables")
        end
      end)
    end
    assert(not one or first and second and third)
    if told then return end
  end
end

-- The chunks of a parallel_for from the last to the first, as threads may come.
local function the_same_in_any_order(plugin, lines)
  local options, setting = { positions = actor.crowd(), gravity = true }, actor.settings(plugin)[1]
  local one, first = actor.fresh(plugin, setting, options)
  local other, second = actor.fresh(plugin, setting, options)
  if not one or not other then return end
  lines:at("%d particles, the chunks of parallel_for in reverse order", actor.CROWD)
  actors.reverse(other)
  local start, random = actors.state(one), actor.random(3)
  local x, v = actor.moved(start.x, random, 0.5), actor.moved(start.v, random, 2)
  for _, a in ipairs { one, other } do actors.set(a, { t = 0.37, x = x, v = v }) end
  local c, d = correct(one, start), correct(other, start)
  if not actor.same(said(c), said(d)) then
    lines:wrong("it corrects otherwise where chunks come in another order: a race",
      "let no two chunks write the same number, and sum chunks in their order")
  end
  for k = 1, actor.CROWD do
    local moves = false
    for e = 3 * k - 2, 3 * k do moves = moves or c.x[e] ~= c.x[e] or c.v[e] ~= c.v[e] end
    if moves and first and second then
      return lines:wrong(("particle %d of a crowd becomes no number"):format(k), "see what is divided by")
    end
  end
end

-- A step of a billionth of a second, in which nothing went far: it can be made no shorter.
local function accepts_short_steps(plugin, lines)
  local SHORT <const> = 1e-9
  actor.each(plugin, lines, function(a)
    local start = actors.state(a)
    local x = {}
    for k = 1, #start.x do x[k] = start.x[k] + SHORT * start.v[k] end
    actors.set(a, { x = x, v = start.v })
    local c, fine, why = actors.correct(a, SHORT, start.x, start.v)
    if not fine then error(("correct failed: %s"):format(why), 0) end
    if c.reject then
      lines:wrong("it takes back a step of 1e-09 s from the start", "a step that is short enough has to be accepted")
    end
  end)
end

-- With the step itself taken back for ever, a run stands still.
local function lets_time_go_on(plugin, lines)
  actor.each(plugin, lines, function(a)
    local start = actors.state(a)
    local rest = {}
    for k = 1, #start.x do rest[k] = 0 end
    actors.set(a, { v = rest })
    if correct(a, { x = start.x, v = rest }).reject then
      lines:wrong("it takes back a step in which nothing moved", "a step that is short enough has to be accepted")
    end
  end)
end

return function(plugin, report)
  local try = actor.watched(plugin, report)
  if not actor.starts(plugin, try) then return end
  try("it says whether it changed x or v", function(l) says_what_it_changed(plugin, l) end)
  try("it reports work and takes steps back only by its flags", function(l) keeps_to_its_flags(plugin, l) end)
  try("finite at degenerate positions", function(l) stays_finite(plugin, l) end)
  try("it stays within its arrays, and two instances do the same", function(l) repeats(plugin, l) end)
  if plugin.has.violation then try("it repairs what `violation` measures", function(l) repairs(plugin, l) end) end
  if plugin.flags & REPORTS_WORK ~= 0 then try("its work", function(l) reports_work(plugin, l) end) end
  if plugin.flags & MAY_REJECT ~= 0 then try("a step at rest is accepted", function(l) lets_time_go_on(plugin, l) end) end
  if plugin.flags & WANTS_BEFORE ~= 0 then report:note("it asks for the positions before the step") end
  try("a short step is accepted", function(l) accepts_short_steps(plugin, l) end)
  try("it keeps nothing outside its instance", function(l) keeps_to_its_instance(plugin, l) end)
  try("the same in a crowd, whatever chunk comes first", function(l) the_same_in_any_order(plugin, l) end)
  try("births and deaths", function(l)
    population.follows(plugin, l, function(a, start) return said(correct(a, start)) end)
  end)
  try("a run with it comes to its end", function(l) falls(plugin, l) end)
  whole_runs.habits(plugin, try, { gravity = true })
end
