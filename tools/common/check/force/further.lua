-- The functions of a force beside its force, energy and Jacobian: elements, bounds of the stiffness, contact, passages,
-- the longest step, and what a checkpoint has to carry.
local inspect = require("inspect")
local members = require("members")
local answers = require("common.check.force.answers")
local cases = require("common.check.force.cases")
local derivatives = require("common.check.force.derivatives")
local worst = require("common.check.force.worst")

local further = {}

local DIFFERENCES = 1e-6 -- as in derivatives.lua
local ROUNDING = 1e-11   -- of sums over all elements of a scene

local function few(case) return case.few end
local function at(case, text) return text and ("%s: %s"):format(case.name, text) or case.name end

local function each_tuple(subject, grain)
  local list = {}
  for _, tuples in ipairs(members.elements(subject, grain) or {}) do
    for _, tuple in ipairs(tuples) do list[#list + 1] = tuple end
  end
  return list
end

-- ---- elements ----

-- Sum over the numbers C of a tuple of factor_e dC_e, added to F.
local function spread(F, tuple, factor_of)
  local arity = #tuple
  for e = 1, #tuple.C do
    local factor = factor_of(e)
    for m = 1, arity do
      for c = 1, 3 do
        local k = 3 * tuple[m] + c
        F[k] = F[k] + factor * tuple.dC[3 * ((e - 1) * arity + m - 1) + c]
      end
    end
  end
end

-- dC_e . z
local function along(tuple, e, z)
  local sum, arity = 0, #tuple
  for m = 1, arity do
    for c = 1, 3 do sum = sum + tuple.dC[3 * ((e - 1) * arity + m - 1) + c] * z[3 * tuple[m] + c] end
  end
  return sum
end

local function gradients_of_elements(subject, case, x, list)
  local dx, least, text = {}, math.huge, nil
  for k = 1, #x do dx[k] = math.sin(2 * k + 1) end
  for _, step in ipairs { 1e-4, 1e-5, 1e-3 } do
    local h, ends = step * case.length, {}
    for s = 1, 2 do
      local to = {}
      for k = 1, #x do to[k] = x[k] + (s == 1 and h or -h) * dx[k] end
      inspect.set(subject, { x = to })
      ends[s] = each_tuple(subject)
    end
    inspect.set(subject, { x = x })
    local measured, stated, scale = {}, {}, 0
    for k, tuple in ipairs(list) do
      for e = 1, #tuple.C do
        measured[#measured + 1] = (ends[1][k].C[e] - ends[2][k].C[e]) / (2 * h)
        stated[#stated + 1] = along(tuple, e, dx)
        scale = math.max(scale, math.abs(tuple.C[e]))
      end
    end
    local figure, said = worst.difference(stated, measured, 16 * 2 ^ -52 * scale / h)
    if figure < least then least, text = figure, said and said:gsub("particle %d+, %a", "along a direction") end
  end
  return least, text
end

local function elements_are_the_force(plugin, lines)
  local gradient, energy, damping, ranges = worst.new(), worst.new(), worst.new(), worst.new()
  cases.each(plugin, lines, few, function(subject, case)
    local x, v = cases.random_state(subject, case, 1)
    local list, n = each_tuple(subject), #x // 3
    for _, tuple in ipairs(list) do
      for _, member in ipairs(tuple) do
        if member >= n then
          return lines:wrong(("its elements name particle %d of %d"):format(member + 1, n), "name indices below view->n")
        end
      end
    end
    gradient:take((gradients_of_elements(subject, case, x, list)), case.name)
    for _, grain in ipairs { 1, 3 } do
      for k, tuple in ipairs(each_tuple(subject, grain)) do
        ranges:take(math.max(worst.difference(tuple.C, list[k].C), (worst.difference(tuple.dC, list[k].dC))),
          ("%s, tuple %d, in ranges of %d"):format(case.name, k, grain))
      end
    end
    local E, lost = 0, {}
    for k = 1, #x do lost[k] = 0 end
    for _, tuple in ipairs(list) do
      for e = 1, #tuple.C do E = E + 0.5 * tuple.stiffness * tuple.C[e] ^ 2 end
      spread(lost, tuple, function(e) return -tuple.damping * along(tuple, e, v) end)
    end
    if plugin.energy then
      local stated = inspect.energy(subject)
      energy:take(math.abs(E - stated) / math.max(math.abs(E), math.abs(stated), 1e-300),
        at(case, ("%.6g J, the elements have %.6g J"):format(stated, E)))
    end
    local moving, rest = inspect.force(subject, 0), {}
    for k = 1, #v do rest[k] = 0 end
    inspect.set(subject, { v = rest })
    local still, difference = inspect.force(subject, 0), {}
    for k = 1, #v do difference[k] = moving[k] - still[k] end
    local figure, text = worst.difference(difference, lost, 1e-13 * worst.largest(moving))
    damping:take(figure, at(case, text))
  end)
  lines:most("dC of its elements is the gradient of C", gradient.figure, DIFFERENCES, "see hk_elements.evaluate",
    gradient.where)
  lines:most("the elements are the same in any ranges", ranges.figure, 0,
    "C and dC start at the first tuple of the range: C[(k - begin) * values + e]; set every number", ranges.where)
  if plugin.energy then
    lines:most("its energy is that of its elements, 1/2 sum k C^2", energy.figure, ROUNDING,
      "elements are offered by forces of that energy alone", energy.where)
  end
  lines:most("its damping is that of its elements, -c dC/dt dC", damping.figure, ROUNDING,
    "see hk_elements.damping; count 0 where there is none", damping.where)
end

-- ---- bounds of the stiffness ----

-- The matrix of blocks `B` less A, scaled.
local function less(B, A, size)
  local rest = {}
  for k = 1, size * size do rest[k] = -A[k] end
  local position = { { 1, 2, 3 }, { 2, 4, 5 }, { 3, 5, 6 } } -- xx, xy, xz, yy, yz, zz
  for i = 0, size // 3 - 1 do
    for a = 1, 3 do
      for b = 1, 3 do
        local k = (3 * i + a - 1) * size + 3 * i + b
        rest[k] = rest[k] + B[6 * i + position[a][b]]
      end
    end
  end
  return rest
end

local function undamped_part(subject, K, size)
  local rest, axis = { table.unpack(K) }, {}
  for _, tuple in ipairs(each_tuple(subject)) do
    for e = 1, #tuple.C do
      for k = 1, size do axis[k] = 0 end
      spread(axis, tuple, function(q) return q == e and 1 or 0 end)
      for r = 1, size do
        for k = 1, size do
          if axis[r] ~= 0 and axis[k] ~= 0 then
            local q = (r - 1) * size + k
            rest[q] = rest[q] - tuple.stiffness * axis[r] * axis[k]
          end
        end
      end
    end
  end
  return rest
end

local parts = { "K", "the undamped part of K", "D" }

local function bounds_hold(plugin, lines)
  local below, adds, loose = {}, worst.new(), {}
  cases.each(plugin, lines, nil, function(subject, case)
    for seed = 1, 2 do
      local x, rest = cases.random_state(subject, case, seed), {}
      local size = #x
      for k = 1, size do rest[k] = 0 end
      inspect.set(subject, { v = rest })
      local K, D = inspect.blocks(subject, 0)
      if not K then
        K = inspect.slopes(subject, "x", 1e-5 * case.length)
        D = inspect.slopes(subject, "v", 1e-2)
      end
      local exact = { K, undamped_part(subject, K, size), D }
      for part = 1, 3 do
        local B, onto = members.bound(subject, part - 1), members.bound(subject, part - 1, 1)
        local scale = math.max(worst.largest(B), worst.largest(exact[part]))
        for k = 1, #B do adds:take(math.abs(onto[k] - B[k] - 1) / math.max(1, math.abs(B[k])), case.name) end
        local finite = scale - scale == 0
        -- 1e-6: K is known by differences where there are no blocks
        if not finite or not derivatives.definite(less(B, exact[part], size), size, 1e3 * scale) then
          below[part] = below[part] or case.name
        end
        -- The widest bound of a sum over pairs counts each of the 3n directions of a row once.
        if finite and not plugin.stiffens and worst.largest(B) > 4 * size * math.max(worst.largest(K), worst.largest(D)) then
          loose[part] = loose[part] or case.name
        end
      end
    end
  end)
  for part, name in ipairs(parts) do
    lines:add(not below[part], ("stiffness_bound is above %s"):format(name), nil, nil,
      "u.K u <= sum u_i.block[i] u_i for all u: of an edge each end gets twice its stiffness", below[part] or false)
    if loose[part] then
      lines:wrong(("stiffness_bound of %s is so far above that it says nothing"):format(name),
        "bound each element by its own stiffness", loose[part])
    end
  end
  lines:most("stiffness_bound adds to what is there", adds.figure, 1e-14, "write block[i][...] += ...", adds.where)
end

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

-- ---- passages ----

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

local function check_law(once, case, pass, from, to)
  local i = pass.i
  for _, ending in ipairs { { pass.F_from, from, "start" }, { pass.F_to, to, "end" } } do
    local F = { ending[2][3 * i + 1], ending[2][3 * i + 2], ending[2][3 * i + 3] }
    local figure, text = worst.difference(ending[1], F)
    if figure > 1e-9 then
      once("law", ("a passage's force is not that of `add` at the %s of the move: %s"):format(ending[3],
        text:gsub("particle 1, ", "")),
        "F is the force on particle i for r from what acts to i; r at the start of the step, dr its change", case.name)
    end
  end
end

local function passages_are_the_force(plugin, lines)
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
      local list = members.passages(subject, x)
      asked = asked or list ~= nil
      list = list or {}
      for _, pass in ipairs(list) do
        named = named + 1
        if pass.i >= #x // 3 or pass.other >= #x // 3 then
          return once("index", "a passage names a particle that does not exist", "name indices below view->n", case.name)
        end
        count[pass.i] = (count[pass.i] or 0) + 1
        if pass.other ~= pass.i then count[pass.other] = (count[pass.other] or 0) + 1 end
        local near, out = norm(pass.F_near), norm(pass.F_out)
        local p = near > 0 and out > 0 and math.log(near / out) / math.log(1.01) or 0
        -- Where F passes an extremum or ends, p says nothing of it.
        if p > 1 and p < 20 and pass.nearest > 0 then
          local expected = pass.nearest / p
          if not (pass.range > expected / 100 and pass.range < 10 * expected) then
            once("range", ("a passage's range is %g m, where F changes by its own size over %g m"):format(pass.range,
              expected), "range is r/p for F = r^-p, where r is least", case.name)
          end
        end
      end
      for _, pass in ipairs(list) do
        if #x == 6 and count[pass.i] == 1 then check_law(once, case, pass, F_from, F_to) end
      end
    end
  end)
  if asked and named == 0 and force > 0 then
    once("none", "its `passages` names none in any scene, where particles pass each other closely",
      "name the moves of more than 4 ranges that come near", false)
  end
  if not next(told) then lines:add(true, ("its passages are those of its force (%d moves)"):format(named)) end
end

-- ---- what a checkpoint carries ----

local function checkpoints_carry_it(plugin, lines)
  cases.each(plugin, lines, function(case) return case.few and case.setting end, function(subject, case)
    if lines.told then return end
    for seed = 1, 3 do
      local x = cases.random_state(subject, case, seed)
      members.update(subject, x)
      inspect.force(subject, 0, 0)
      members.accepted(subject, 0.01)
    end
    local second = cases.open(plugin, case)
    local restored = inspect.open(second, plugin.name)
    local fine = members.restore(restored, members.save(subject))
    inspect.set(restored, inspect.state(subject))
    local text = fine and answers.difference(answers.all(subject), answers.all(restored), 1e-12)
    if text or not fine then
      lines.told = true
      lines:wrong("what evolves is not in its fields, so that a run goes on otherwise from a checkpoint: " .. (text or
        "the fields cannot be restored"), "put all data that change during a run into the table of fields")
    end
  end)
end

function further.try(plugin, report)
  local has = plugin.has
  local function try(there, name, body)
    if there then report:try(name, function(lines) body(plugin, lines) end) end
  end
  try(has.elements, "its elements", elements_are_the_force)
  try(has.stiffness_bound, "its stiffness_bound", bounds_hold)
  try(has.update or has.step_limit, "contact", contact_is_safe)
  try(has.longest_step, "longest_step is above 0", longest_step_is_a_time)
  try(has.passages, "its passages", passages_are_the_force)
  try(true, "checkpoints carry all that evolves", checkpoints_carry_it)
end

return further
