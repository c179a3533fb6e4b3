-- All that a force answers at a state, as named arrays of numbers: what is compared where two instances, or two calls,
-- have to agree.
local inspect = require("inspect")
local members = require("members")
local worst = require("common.check.force.worst")

local answers = {}

local function elements_of(subject)
  local flat = {}
  for _, list in ipairs(members.elements(subject) or {}) do
    for _, tuple in ipairs(list) do
      for _, value in ipairs(tuple.C) do flat[#flat + 1] = value end
      for _, value in ipairs(tuple.dC) do flat[#flat + 1] = value end
      flat[#flat + 1] = tuple.stiffness
      flat[#flat + 1] = tuple.damping
    end
  end
  return flat
end

-- { { name, numbers }, ... } at the subject's present state.
function answers.all(subject)
  local n = inspect.state(subject).n
  local list, dx = {}, {}
  local function add(name, numbers) if numbers then list[#list + 1] = { name, numbers } end end
  for k = 1, 3 * n do dx[k] = math.sin(k) end
  local x = inspect.state(subject).x
  local x_to = {}
  for k = 1, 3 * n do x_to[k] = x[k] + 1e-3 * dx[k] end
  members.update(subject, x_to)
  local F, power = inspect.force(subject, 0, 0)
  add("F", F)
  add("power", { power })
  add("energy", { inspect.energy(subject) })
  add("the rates", inspect.rates(subject))
  local K, D = inspect.blocks(subject, 0)
  add("K", K)
  add("D", D)
  for part = 0, 2 do add("stiffness_bound", members.bound(subject, part)) end
  add("the elements", elements_of(subject))
  local limit, longest = members.limit(subject, dx), members.longest(subject)
  add("step_limit", limit and { limit })
  add("longest_step", longest and longest < math.huge and { longest })
  members.encounters(subject, x_to)
  return list
end

-- NaN as a text's worth of a number: equal to itself.
local function finite(numbers)
  local list = {}
  for k = 1, #numbers do list[k] = numbers[k] == numbers[k] and numbers[k] or math.huge end
  return list
end

-- The first of the named arrays that differs by more than `bound`, in a sentence; nil: none does. Bits count where
-- `bound` is nil.
function answers.difference(a, b, bound)
  for k = 1, math.max(#a, #b) do
    if not a[k] or not b[k] then return "another number of answers" end
    local name, p, q = a[k][1], a[k][2], b[k][2]
    if #p ~= #q then return ("%s has %d numbers, then %d"):format(name, #p, #q) end
    for e = 1, #p do
      local same = p[e] == q[e] or (p[e] ~= p[e] and q[e] ~= q[e])
      if not same and not bound then return ("%s: %.17g, then %.17g"):format(name, p[e], q[e]) end
    end
    if bound then
      p, q = finite(p), finite(q)
      local figure, text = worst.difference(p, q)
      if figure > bound then return ("%s: %s"):format(name, text or "") end
    end
  end
end

return answers
