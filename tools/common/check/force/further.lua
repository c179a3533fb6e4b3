-- The functions of a force beside its force, energy and Jacobian: elements, bounds of the stiffness, and what a checkpoint
-- has to carry; contact and encounters are in contact.lua.
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

local function energy_of(list)
  local E = 0
  for _, tuple in ipairs(list) do
    for e = 1, #tuple.C do E = E + 0.5 * tuple.stiffness * tuple.C[e] ^ 2 end
  end
  return E
end

-- Energies of the elements and of the force at x, less those at the start: neither knows the other's constant.
local function energies(subject, case, x)
  inspect.set(subject, { x = case.start.x })
  local elements, stated = energy_of(each_tuple(subject)), inspect.energy(subject)
  inspect.set(subject, { x = x })
  local of_elements, of_force = energy_of(each_tuple(subject)), inspect.energy(subject)
  local scale = math.max(math.abs(elements), math.abs(of_elements), math.abs(stated), math.abs(of_force), 1e-300)
  return of_elements - elements, of_force - stated, scale
end

local function elements_are_the_force(plugin, lines)
  local gradient, energy, damping, ranges = worst.new(), worst.new(), worst.new(), worst.new()
  cases.each(plugin, lines, few, function(subject, case)
    local x, v = cases.random_state(subject, case, 1)
    if not members.elements(subject) then return end
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
    local lost = {}
    for k = 1, #x do lost[k] = 0 end
    for _, tuple in ipairs(list) do
      spread(lost, tuple, function(e) return -tuple.damping * along(tuple, e, v) end)
    end
    if plugin.energy then
      local E, stated, scale = energies(subject, case, x)
      energy:take(math.abs(E - stated) / scale,
        at(case, ("%.6g J above the start, the elements have %.6g J"):format(stated, E)))
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
    lines:most("its energy is that of its elements, 1/2 sum k C^2 and a constant", energy.figure, ROUNDING,
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
local DAMPING = 3

local function matrices_at(subject, case)
  local K, D = inspect.blocks(subject, 0)
  if K then return K, D end
  return inspect.slopes(subject, "x", 1e-5 * case.length), inspect.slopes(subject, "v", 1e-2)
end

-- Calls visit(part, matrix, most) for what has to be below a bound of the state: K and D of particles at rest, and D of
-- particles that move, as the estimate of the stable step takes it. most: the largest number of all.
local function each_bounded(subject, case, seed, visit)
  local x, v = cases.random_state(subject, case, seed)
  local _, moving = matrices_at(subject, case)
  local size, rest = #x, {}
  for k = 1, size do rest[k] = 0 end
  inspect.set(subject, { v = rest })
  local K, D = matrices_at(subject, case)
  local most = math.max(worst.largest(K), worst.largest(D), worst.largest(moving))
  visit(1, K, most)
  visit(2, undamped_part(subject, K, size), most)
  visit(DAMPING, D, most)
  inspect.set(subject, { v = v })
  visit(DAMPING, moving, most)
end

local function bounds_hold(plugin, lines)
  local below, adds, loose = {}, worst.new(), {}
  cases.each(plugin, lines, nil, function(subject, case)
    local function hold(part, exact, most)
      local size = math.floor((#exact) ^ 0.5 + 0.5)
      local B, onto = members.bound(subject, part - 1), members.bound(subject, part - 1, 1)
      local scale = math.max(worst.largest(B), worst.largest(exact))
      for k = 1, #B do adds:take(math.abs(onto[k] - B[k] - 1) / math.max(1, math.abs(B[k])), case.name) end
      local finite = scale - scale == 0
      -- 1e-6: K is known by differences where there are no blocks
      if not finite or not derivatives.definite(less(B, exact, size), size, 1e3 * scale) then
        below[part] = below[part] or case.name
      end
      -- The widest bound of a sum over pairs counts each of the 3n directions of a row once.
      if finite and not plugin.stiffens and worst.largest(B) > 4 * size * most then
        loose[part] = loose[part] or case.name
      end
    end
    for seed = 1, 2 do each_bounded(subject, case, seed, hold) end
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

-- ---- what a checkpoint carries ----

local function checkpoints_carry_it(plugin, lines)
  cases.each(plugin, lines, function(case) return case.few and case.setting end, function(subject, case)
    if lines.told then return end
    for seed = 1, 3 do
      local x = cases.random_state(subject, case, seed)
      members.update(subject, x)
      inspect.force(subject, 0, 0)
      members.accepted(subject, 0.01)
      members.evolve(subject, 0.01)
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
  try(true, "checkpoints carry all that evolves", checkpoints_carry_it)
end

return further
