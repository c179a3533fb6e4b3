-- Contact and short range: `update` and `step_limit`, the longest step, and the encounters that steps go by.
local inspect = require("inspect")
local members = require("members")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local contact = {}

-- ---- contact ----

-- Moves of a size that lets neighbours meet.
local function moves(x, case)
  local list = {}
  for q, size in ipairs { 0.2, 1, 4 } do
    local dx = {}
    for k = 1, #x do dx[k] = size * case.length * math.sin(1.3 * k + 5 * q) end
    list[q] = dx
  end
  local through = {} -- each second particle straight through the one before it
  for c = 1, 3 do through[c] = 0 end
  for k = 1, #x - 3 do through[k + 3] = (k - 1) // 3 % 2 == 0 and 2 * (x[k] - x[k + 3]) or 0 end
  list[#list + 1] = through
  return list
end

local function plus(x, factor, dx)
  local to = {}
  for k = 1, #x do to[k] = x[k] + factor * dx[k] end
  return to
end

local function pattern_text(subject) return table.concat(inspect.pattern(subject) or {}, " ") end

-- `update` finds all that acts on the way: what another instance, told of that very state, says.
local function update_misses_nothing(lines, subject, fresh, case, x, dx, most)
  for _, part in ipairs { 0, 0.25, 0.5, 0.75, 1 } do
    local to = plus(x, part * most * 0.999, dx)
    inspect.set(fresh, { x = to })
    members.update(fresh, to)
    inspect.set(subject, { x = to })
    local figure, text = worst.difference(inspect.force(subject, 0), (inspect.force(fresh, 0)))
    if figure > 1e-9 then
      lines:wrong("its `update` misses what acts on the way: " .. text,
        "look for elements along the whole move, from view->x to x_to", ("%s, %g of the move"):format(case.name, part))
      return false
    end
  end
  return true
end

local function contact_is_safe(plugin, lines)
  local told = {}
  local function once(key, ...)
    if not told[key] then told[key] = true lines:wrong(...) end
  end
  local conservative = plugin.energy and not plugin.power
  cases.each(plugin, lines, nil, function(subject, case)
    local other = cases.open(plugin, case)
    local fresh = inspect.open(other, plugin.name)
    local x = inspect.state(subject).x
    for _, dx in ipairs(moves(x, case)) do
      inspect.set(subject, { x = x })
      local before = pattern_text(subject)
      local changed, fine = members.update(subject, plus(x, 1, dx))
      if fine == false then once("fails", "its `update` fails", "return HK_OK, or host->fail with the cause") end
      if changed == false and pattern_text(subject) ~= before then
        once("pattern", "its `update` changes the blocks and does not say so", "set *pattern_changed = true")
      end
      local most = members.limit(subject, dx) or 1
      if not (most > 0 and most <= 1) then
        once("limit", ("step_limit is %g: must be above 0 and at most 1"):format(most), "return 1 where a move is safe")
        most = 1
      end
      if inspect.energy(subject) < math.huge and worst.largest(inspect.force(subject, 0)) < math.huge then
        for part = 0, 1, 1 / 64 do
          inspect.set(subject, { x = plus(x, part * most, dx) })
          local E = inspect.energy(subject)
          if part < 1 and not (E - E == 0 and worst.largest(inspect.force(subject, 0)) < math.huge) then
            once("unsafe", ("step_limit lets through what is not safe: the energy is %g J at %g of it"):format(E, part),
              "the fraction must end before the distance reaches zero anywhere on the straight way")
          end
        end
      end
      inspect.set(subject, { x = x })
      members.update(subject, plus(x, 1, dx))
      if plugin.has.update and conservative and not told.misses then
        told.misses = not update_misses_nothing(lines, subject, fresh, case, x, dx, most)
      end
    end
  end)
  if not next(told) or (told.misses == false and not next(told, next(told))) then
    lines:add(true, "update and step_limit find what is on the way")
  end
end

local function longest_step_is_a_time(plugin, lines)
  cases.each(plugin, lines, nil, function(subject, case)
    if lines.told then return end
    cases.random_state(subject, case, 1)
    local h = members.longest(subject)
    if h <= 0 or h ~= h then
      lines.told = true
      lines:wrong(("longest_step is %g s: the host takes no notice of it"):format(h),
        "return a time above 0; INFINITY where there is no bound")
    end
  end)
end

-- ---- encounters ----

-- Moves past each other, of many lengths: particle by particle in turn through where the others are.
local function passing(x, length, q)
  local dx = {}
  for k = 1, #x do
    local i, c = (k - 1) // 3, (k - 1) % 3
    dx[k] = (i % 2 == q % 2 and -2 or 2) * (x[3 * i + c + 1] + 0.03 * length * math.sin(k + q)) + 0.3 * length * math.cos(k)
  end
  return dx
end

local function norm(a) return math.sqrt(a[1] ^ 2 + a[2] ^ 2 + a[3] ^ 2) end

local function check_law(once, case, move, from, to)
  local i = move.i
  for _, ending in ipairs { { move.F_from, from, "start" }, { move.F_to, to, "end" } } do
    local F = { ending[2][3 * i + 1], ending[2][3 * i + 2], ending[2][3 * i + 3] }
    local figure, text = worst.difference(ending[1], F)
    if figure > 1e-9 then
      once("law", ("an encounter's force is not that of `add` at the %s of the move: %s"):format(ending[3],
        text:gsub("particle 1, ", "")),
        "F is the force on particle i for r from what acts to i; r at the start of the step, dr its change", case.name)
    end
  end
end

local function encounters_are_the_force(plugin, lines)
  local told, named = {}, 0
  local function once(key, text, remedy, where)
    if not told[key] then told[key] = true lines:wrong(text, remedy, where) end
  end
  local force, asked = 0, false
  cases.each(plugin, lines, nil, function(subject, case)
    local x = inspect.state(subject).x
    for q = 1, 4 do
      local to = plus(x, 1, passing(x, case.length, q))
      inspect.set(subject, { x = x })
      local F_from = inspect.force(subject, 0)
      inspect.set(subject, { x = to })
      local F_to, count = inspect.force(subject, 0), {}
      force = math.max(force, worst.largest(F_to))
      local list = members.encounters(subject, x)
      asked = asked or list ~= nil
      list = list or {}
      for _, move in ipairs(list) do
        named = named + 1
        if move.i >= #x // 3 or move.other >= #x // 3 then
          return once("index", "an encounter names a particle that does not exist", "name indices below view->n", case.name)
        end
        count[move.i] = (count[move.i] or 0) + 1
        if move.other ~= move.i then count[move.other] = (count[move.other] or 0) + 1 end
        local near, out = norm(move.F_near), norm(move.F_out)
        local p = near > 0 and out > 0 and math.log(near / out) / math.log(1.01) or 0
        -- Where F passes an extremum or ends, p says nothing of it.
        if p > 1 and p < 20 and move.nearest > 0 then
          local expected = move.nearest / p
          if not (move.range > expected / 100 and move.range < 10 * expected) then
            once("range", ("an encounter's range is %g m, where F changes by its own size over %g m"):format(move.range,
              expected), "range is r/p for F = r^-p, where r is least", case.name)
          end
        end
      end
      for _, move in ipairs(list) do
        if #x == 6 and count[move.i] == 1 then check_law(once, case, move, F_from, F_to) end
      end
    end
  end)
  if asked and named == 0 and force > 0 then
    once("none", "its `encounters` names none in any scene, where particles pass each other closely",
      "name the moves of more than 4 ranges that come near", false)
  end
  if not next(told) then lines:add(true, ("its encounters are those of its force (%d moves)"):format(named)) end
end

function contact.try(plugin, report)
  local has = plugin.has
  local function try(there, name, body)
    if there then report:try(name, function(lines) body(plugin, lines) end) end
  end
  try(has.update or has.step_limit, "contact", contact_is_safe)
  try(has.longest_step, "longest_step is above 0", longest_step_is_a_time)
  try(has.encounters, "its encounters", encounters_are_the_force)
end

return contact
