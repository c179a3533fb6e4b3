-- Internal variables: what `evolve` says it dissipated has to be what is missing in the energy when particles are led along
-- lines and back, and what it says of the force and the blocks has to be so.
local inspect = require("inspect")
local members = require("members")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local internal = {}

local STEPS, H = 200, 2e-3 -- of one line; s
local MISSING = 2e-3 -- of the work by sums over 200 steps, whose error is some 1e-5, and some 1e-4 where elements begin to flow
local SAME = 1e-9 -- relative, of what is computed before and after a call: rounding

local function pattern_of(subject) return table.concat(inspect.pattern(subject) or {}, ",") end

-- The work of the outside against the force over the change dx, J, less what the force gained by itself in H.
local function work_of(F, next_F, dx, power)
  local sum = 0
  for k = 1, #dx do sum = sum - (F[k] + next_F[k]) / 2 * dx[k] end
  return sum + power * H
end

-- Where the walk is: the force after `evolve`, its power, its blocks.
local function look(subject)
  local F, power = inspect.force(subject, 0, 0)
  return { F = F, power = power, pattern = pattern_of(subject) }
end

-- Leads the particles to x1; adds to account.work, .lost, .size. `told` is called with what is wrong.
local function lead(subject, x1, account, told)
  local x0, dx, v, x = inspect.state(subject).x, {}, {}, {}
  for k = 1, #x1 do dx[k], v[k] = (x1[k] - x0[k]) / STEPS, (x1[k] - x0[k]) / STEPS / H end
  inspect.set(subject, { v = v })
  account.lost = account.lost + members.evolve(subject, 0)
  local here = look(subject)
  for step = 1, STEPS do
    for k = 1, #x1 do x[k] = step == STEPS and x1[k] or x0[k] + step * dx[k] end
    account.t = account.t + H
    inspect.set(subject, { x = x, t = account.t })
    local F, power = inspect.force(subject, 0, 0)
    local work = work_of(here.F, F, dx, (here.power + power) / 2)
    local lost, changed, other_blocks, fine = members.evolve(subject, H)
    local after = look(subject)
    if not fine then told("its `evolve` fails", "a state that can be reached must be one that it can take") end
    if not changed and worst.difference(after.F, F) > SAME then
      told("its `evolve` changes the force and does not say so", "set e->changed, so that methods drop their histories")
    end
    if not other_blocks and after.pattern ~= here.pattern then
      told("its `evolve` changes the blocks and does not say so", "set e->pattern_changed")
    end
    account.work, account.lost = account.work + work, account.lost + lost
    account.size, here = account.size + math.abs(work), after
  end
end

-- The same state once more, after no time. Rounding may let a little flow on.
local function again(subject, account, told)
  local F = inspect.force(subject, 0)
  local lost, changed = members.evolve(subject, 0)
  if math.abs(lost) > SAME * account.size or changed or worst.difference(inspect.force(subject, 0), F) > SAME then
    told("its `evolve` changes something when it is called again for the same state, after 0 s",
      "let what it does follow from the state and the internal variables")
  end
end

local function balance(plugin, lines)
  local missing, seen, lost = worst.new(), {}, 0
  cases.each(plugin, lines, function(case) return case.few and not case.limits end, function(subject, case)
    local function told(what, remedy)
      if not seen[what] then lines:wrong(what, remedy, case.name) end
      seen[what] = true
    end
    local start, account = inspect.state(subject), { work = 0, lost = 0, size = 0, t = inspect.state(subject).t }
    members.evolve(subject, 0)
    local first = inspect.energy(subject)
    for seed = 1, 2 do
      local there = {}
      local x = cases.random_state(subject, case, seed)
      for k = 1, #x do there[k] = start.x[k] + seed * (x[k] - start.x[k]) end
      inspect.set(subject, { x = start.x, t = account.t })
      lead(subject, there, account, told)
      again(subject, account, told)
      lead(subject, start.x, account, told)
    end
    lost = lost + math.abs(account.lost)
    missing:take(math.abs(account.work - (inspect.energy(subject) - first) - account.lost) / math.max(account.size, 1e-300),
      case.name)
  end)
  lines:most("what it dissipates is what is missing in the energy", missing.figure, MISSING,
    "e->dissipated, J, is the work done on the elements less the rise of `energy`, summed over the elements that act",
    missing.where)
  if lost == 0 then lines:note("it dissipates nothing in the scenes of the check") end
end

function internal.try(plugin, report)
  if plugin.has.evolve then report:try("what it dissipates", function(lines) balance(plugin, lines) end) end
end

return internal
