-- What every plugin owes its host, tried on a force: it stays within its arrays, reads nothing that was not written,
-- allocates and leaks nothing, keeps nothing outside its instance, and says the same twice, on any number of threads.
local inspect = require("inspect")
local members = require("members")
local answers = require("common.check.force.answers")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local habits = {}

local function few(case) return case.few end

-- ---- memory ----

local function stays_within_its_arrays(plugin, lines)
  for _, side in ipairs { "behind", "before" } do
    cases.each(plugin, lines, function(case) return case.few and (side == "behind" or case.base) end,
      function(subject, case)
        cases.random_state(subject, case, 1)
        answers.all(subject)
      end, { side = side })
  end
  for seed = 1, 2 do
    cases.each(plugin, lines, function(case) return case.base and case.few end, function(subject, case)
      cases.random_state(subject, case, seed)
      answers.all(subject)
    end, { only = cases.some, side = seed == 1 and "behind" or "before" })
  end
end

-- New memory of the heap and the stack below each call hold two different garbages.
local function reads_what_was_written(plugin, lines)
  local first = {}
  for round, fill in ipairs { 0, 0xc1 } do
    inspect.fill(fill)
    cases.each(plugin, lines, few, function(subject, case)
      inspect.set(subject, { fill = fill })
      cases.random_state(subject, case, 1)
      local all = answers.all(subject)
      if round == 1 then first[case.name] = all return end
      local text = answers.difference(first[case.name], all)
      if text and not lines.told then
        lines.told = true
        lines:wrong("it reads memory that was never written: " .. text,
          "initialise every variable, and all of the memory of malloc (host->allocate gives zeros)")
      end
    end)
  end
end

local function allocates_nothing(plugin, lines)
  local told
  local before, freed_before = inspect.heap()
  cases.each(plugin, lines, few, function(subject, case, run)
    cases.random_state(subject, case, 1)
    answers.all(subject)
    local calls, asked = 0, 0
    for seed = 2, 4 do
      cases.random_state(subject, case, seed)
      local a, left = inspect.heap(), members.left(run)
      inspect.force(subject, 0, 0)
      inspect.energy(subject)
      inspect.blocks(subject, 0)
      calls, asked = calls + inspect.heap() - a, asked + left - members.left(run)
    end
    members.change(run, { 1 }, {}) -- what `topology` replaces is freed as well
    if told or calls + asked == 0 then return end
    told = true
    lines:wrong(("it allocates in a step: %d times in three evaluations, by %s"):format(calls + asked,
      calls > 0 and "malloc" or "host->allocate"), "allocate in `create` and `topology`")
  end, { allocations = 1 << 40, destroy = true })
  local allocated, freed = inspect.heap()
  local lost = (allocated - before) - (freed - freed_before)
  if lost > 0 then
    lines:wrong(("it leaks memory: %d of %d blocks of malloc were not freed"):format(lost, allocated - before),
      "free them in `destroy`, or take them from host->allocate")
  end
end

-- Every allocation fails in turn.
local function survives_a_lack_of_memory(plugin, lines)
  local list = cases.list(plugin)
  for _, case in ipairs(list) do
    if cases.open(plugin, case) then
      for k = 1, 12 do
        lines:at("%s, where allocation %d of its plugins fails", case.name, k)
        local run, why = cases.open(plugin, case, { allocations = k })
        if not run and not why:lower():find("memory", 1, true) then
          lines:wrong("without memory it fails with another message: " .. why, "return HK_NO_MEMORY")
          return
        end
      end
      return
    end
  end
end

-- ---- one instance, and others beside it ----

-- The first case of several particles; nothing is opened here.
local function first_case(plugin)
  for _, case in ipairs(cases.list(plugin)) do
    if case.setting and case.few then return case end
  end
end

local function answer_of(run, plugin, case)
  local subject = inspect.open(run, plugin.name)
  cases.random_state(subject, case, 1)
  return answers.all(subject), subject
end

local function keeps_to_its_instance(plugin, lines)
  local case = first_case(plugin)
  if not case then return end
  lines:at(case.name)
  local first = cases.open(plugin, case)
  local alone, subject = answer_of(first, plugin, case)
  local other = cases.variant(case, cases.chain(5), plugin)
  lines:at("%s, beside an instance in a %s with other numbers", case.name, other.shape.name)
  local second = cases.open(plugin, other)
  if not second then return end
  local beside = answer_of(second, plugin, other)
  local text = answers.difference(alone, answers.all(subject))
  if text then
    lines:wrong("it depends on another instance: " .. text, "keep all data in the instance, no static variables")
  end
  lines:value(beside)
end

-- The second instance of keeps_to_its_instance, without the first.
local function second_alone(plugin, lines)
  local case = first_case(plugin)
  local other = case and cases.variant(case, cases.chain(5), plugin)
  local run = other and cases.open(plugin, other)
  if run then lines:value((answer_of(run, plugin, other))) end
end

-- ---- the same twice ----

local function says_the_same_twice(plugin, lines)
  local told
  local adds, powers, force, rates = worst.new(), worst.new(), 0, 0
  cases.each(plugin, lines, nil, function(subject, case)
    for seed = 1, 3 do
      cases.random_state(subject, case, seed)
      local F, _, fine = inspect.force(subject, 0)
      local twice, power = inspect.force(subject, 0, 0)
      local figure, text = worst.difference(F, twice)
      if not told and (figure > 0 or not fine) then
        told = true
        if not fine then lines:wrong("its `add` fails at a random state", "return HK_OK, or host->fail with the cause")
        else lines:wrong("it says something else the second time, with its power asked for: " .. text,
          "let `add` depend on the state and the instance's constants alone") end
      end
      local size = worst.largest(F)
      if size - size ~= 0 and not told then
        told = true
        lines:wrong("its force is not finite at a random state", "see what is divided by")
      end
      force = math.max(force, size)
      rates = math.max(rates, worst.largest(inspect.rates(subject) or {}))
      local onto, more = inspect.force(subject, 1, 5), {}
      for k = 1, #F do more[k] = F[k] + 1 end
      adds:take(worst.difference(onto, more) * math.max(1, size) / math.max(1, size), case.name)
      local _, again = inspect.force(subject, 0, 5)
      powers:take(math.abs(again - power) / math.max(5, math.abs(power)), case.name)
    end
  end)
  if told then return end
  lines:add(true, "the same twice, with and without its power")
  if force == 0 and rates == 0 and not plugin.publishes then
    return lines:wrong("its force is zero at every state of every scene: nothing is checked",
      "give parameters by name=value, or a scene in which it acts by --scene FILE", false)
  end
  lines:most("it adds to what is there (F += ...)", adds.figure, 1e-14, "write F[3*i + c] += ..., never =", adds.where)
  lines:most("it adds to the power that is there", powers.figure, 1e-14, "write *view->power += ...", powers.where)
end

-- ---- threads ----

local REPEATS = 6

-- Elements across and along the particles' order: of a sheet far apart, of a chain next to each other.
local function large_shapes() return { { cases.chain(1200), { 1, 4 } }, { cases.sheet(40, 40), { 1, 2, 3, 8 } } } end

local function agrees_on_any_threads(plugin, lines)
  local base = first_case(plugin)
  if not base then return end
  for _, large in ipairs(large_shapes()) do
    local case, first = cases.variant(base, large[1]), nil
    for _, threads in ipairs(large[2]) do
      lines:at("%s with %d threads", case.name, threads)
      local run = cases.open(plugin, case, { threads = threads })
      if not run then return end
      local subject = inspect.open(run, plugin.name)
      cases.random_state(subject, case, 1)
      if threads == 1 then
        lines.seconds = inspect.seconds(subject)
        lines.size = #large[1].positions
      end
      for round = 1, threads == 1 and 2 or REPEATS do
        if threads == 1 and round == 2 then
          lines:at("%s with the chunks of parallel_for in reverse order", case.name)
          inspect.reverse(subject)
        end
        local bytes = inspect.bytes(subject)
        first = first or bytes
        if bytes ~= first then
          return lines:wrong("F is not the same with several threads: a race",
            "let no two chunks write the same number: sum by particle, or in buffers per chunk in their order")
        end
      end
    end
  end
  lines:note(("%.3g ns per particle of a sheet"):format(1e9 * lines.seconds / lines.size))
end

-- ---- where it acts ----

local function acts_where_it_should(plugin, lines)
  local tried, told = false, {}
  local function wrong(key, ...)
    if not told[key] then told[key] = true lines:wrong(...) end
  end
  cases.each(plugin, lines, function(case) return case.few and case.setting end, function(subject, case)
    local active, n = members.selection(subject), #case.shape.positions
    if not active then return end
    tried = true
    local x = cases.random_state(subject, case, 1)
    local function outside(numbers, width)
      for k = 1, #numbers do
        local i = (k - 1) // width + 1
        if not active[i] and numbers[k] ~= 0 then return i, numbers[k] end
      end
    end
    local i, f = outside(inspect.force(subject, 0), 3)
    if i then wrong("F", ("it acts on particle %d, which it shall leave alone: F = %g N"):format(i, f),
      "go through view->active, or ask view->is_active of every member of a tuple") end
    local E = inspect.energy(subject)
    for q = 1, n do
      if not active[q] then
        local moved = { table.unpack(x) }
        moved[3 * q] = moved[3 * q] + 0.1
        inspect.set(subject, { x = moved })
        local now = inspect.energy(subject)
        if now ~= E then wrong("E", ("its energy depends on particle %d, on which it does not act: %.9g J, then %.9g J"
          ):format(q, E, now), "sum the energy over the same particles and tuples as `add`") end
      end
    end
    inspect.set(subject, { x = x })
    local K, D = inspect.blocks(subject, 0)
    for name, A in pairs(K and { K = K, D = D } or {}) do
      local at, value = outside(A, 9 * n)
      if at then wrong(name, ("its Jacobian %s has entries for particle %d, on which it does not act: %g"):format(name,
        at, value), "name and fill the blocks of the same tuples as `add`") end
    end
    for part = 0, 2 do
      local B = members.bound(subject, part)
      local at, value = outside(B or {}, 6)
      if at then wrong("bound", ("its stiffness_bound counts particle %d, on which it does not act: %g"):format(at, value),
        "bound the same tuples as `add`") end
    end
    for _, list in ipairs(members.elements(subject) or {}) do
      for _, tuple in ipairs(list) do
        for _, member in ipairs(tuple) do
          if not active[member + 1] then wrong("elements", ("its elements have particle %d, on which it does not act"
            ):format(member + 1), "offer the tuples that act, and no other") end
        end
      end
    end
  end, { only = cases.some })
  if tried then lines:add(next(told) == nil, "it acts on the particles of `only` alone, in all it answers", nil, nil,
    "see above", false) end
end

-- ---- degenerate states ----

local degenerate = {
  { "coincident particles", function(x) for k = 1, #x do x[k] = 0 end end },
  { "two coincident particles", function(x) for c = 1, 3 do x[3 + c] = x[c] end end },
  { "collinear particles", function(x) for k = 1, #x do x[k] = k % 3 == 1 and 0.37 * (k // 3) or 0 end end },
  { "flat particles", function(x) for k = 2, #x, 3 do x[k] = 0 end end },
  { "mirrored particles", function(x) for k = 1, #x, 3 do x[k] = -x[k] end end },
  { "particles 1e-12 m apart", function(x) for k = 1, #x do x[k] = 1e-12 * x[k] end end },
  { "particles far away (1e9 m)", function(x) for k = 1, #x do x[k] = x[k] + 1e9 end end },
}

local function all_finite(numbers)
  for k = 1, #numbers do
    if numbers[k] - numbers[k] ~= 0 then return false end
  end
  return true
end

local function finite_everywhere(plugin, lines)
  local told = {}
  cases.each(plugin, lines, few, function(subject, case)
    for _, shape in ipairs(degenerate) do
      local x, v = { table.unpack((cases.random_state(subject, case, 1))) }, {}
      shape[2](x)
      for k = 1, #x do v[k] = 0 end
      inspect.set(subject, { x = x, v = v })
      if case.limits then members.update(subject, x) end
      local reached = not case.limits or inspect.energy(subject) < math.huge
      for _, answer in ipairs(reached and answers.all(subject) or {}) do
        local ours = answer[1] ~= "the elements"
        if ours and not told[shape[1]] and not all_finite(answer[2]) then
          told[shape[1]] = true
          lines:wrong(("%s is not finite with %s"):format(answer[1], shape[1]),
            "give a limit, or zero, where a distance or an area that is divided by vanishes")
        end
      end
    end
  end)
  for _, shape in ipairs(degenerate) do
    if not told[shape[1]] then lines:add(true, "finite with " .. shape[1]) end
  end
end

-- ---- values out of range ----

local function outside(p)
  local list = {}
  if not p.min then return list end
  if p.above_min then list[1] = p.min
  elseif p.min > -math.huge then list[1] = p.min - 1 - math.abs(p.min) end
  if p.max < math.huge then list[#list + 1] = p.max + 1 + math.abs(p.max) end
  return list
end

local function refuses_what_is_out_of_range(plugin, lines)
  local case = first_case(plugin)
  local numeric = { number = true, integer = true, ["per tuple"] = true }
  for _, p in ipairs(case and plugin.params or {}) do
    for _, value in ipairs(numeric[p.type] and outside(p) or {}) do
      local values = {}
      for name, v in pairs(case.setting.values) do values[name] = v end
      values[p.name] = value
      local run, why = cases.open(plugin, { shape = case.shape, setting = { values = values } })
      lines:add(not run and why:find(p.name, 1, true), ("%s = %g is refused, by name"):format(p.name, value), nil, nil,
        "see min and max of the parameter table", false)
    end
  end
end

habits.list = {
  { "it stays within its arrays", stays_within_its_arrays },
  { "the same twice", says_the_same_twice },
  { "it reads no memory that was not written", reads_what_was_written },
  { "it allocates nothing in a step and leaks nothing", allocates_nothing },
  { "it fails cleanly without memory", survives_a_lack_of_memory },
  { "finite at degenerate states", finite_everywhere },
  { "only = ids", acts_where_it_should },
  { "threads", agrees_on_any_threads },
  { "values out of range", refuses_what_is_out_of_range },
}

-- Compares an instance beside another one with the same instance alone, in two processes.
function habits.instances(plugin, report)
  local name = "it keeps nothing outside its instance"
  local fine, beside = report:try(name, function(lines) keeps_to_its_instance(plugin, lines) end)
  if not fine or not beside[1] then return end
  local again, alone = report:try(nil, function(lines) second_alone(plugin, lines) end)
  local text = again and alone[1] and answers.difference(alone[1], beside[1])
  if text then
    report:print { property = "it depends on an instance that was made before: " .. text,
      remedy = "keep all data in the instance, no static variables" }
  end
end

return habits
