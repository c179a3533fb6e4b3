-- A force is a function of the state and its parameters: it says the same again after many calls, after other states and
-- times, and when the clocks have gone on; and it opens no files for that.
local inspect = require("inspect")
local members = require("members")
local answers = require("common.check.force.answers")
local cases = require("common.check.force.cases")

local repeats = {}

local MANY = 300 -- evaluations, after which a count of them has shown itself
local LATER = 1e5 -- s, that the clocks go on

local function wanted(case) return case.base and case.few end

local function same_later(plugin, lines)
  local told = false
  cases.each(plugin, lines, wanted, function(subject, case)
    local x, v = cases.random_state(subject, case, 1)
    local state = inspect.state(subject)
    local F, E = inspect.bytes(subject), inspect.energy(subject)
    local function compare(after)
      local now, energy = inspect.bytes(subject), inspect.energy(subject)
      if told or (now == F and (energy == E or E ~= E)) then return end
      told = true
      lines:wrong(("at the same state it has another %s %s"):format(now == F and "energy" or "force", after),
        "let `add` and `energy` depend on the view and the parameters alone, not on calls, clocks or the states before")
    end
    inspect.clock(LATER)
    compare("when the clock has gone on")
    inspect.clock(0)
    for k = 1, MANY do inspect.force(subject, 0, k % 2 == 0 and 0 or nil) end
    compare(("after %d evaluations"):format(MANY))
    if case.limits then return end -- what is near is found by `update` for one state
    for k = 1, 20 do
      local moved = {}
      for e = 1, #x do moved[e] = x[e] + 1e-3 * k * v[e] end
      inspect.set(subject, { x = moved, t = state.t + 1e-3 * k })
      inspect.force(subject, 0, 0)
      inspect.energy(subject)
    end
    inspect.set(subject, { x = x, v = v, y = state.y, t = state.t })
    compare("after evaluations at other states and times")
  end)
end

local function opens_no_files(plugin, lines)
  local told = false
  cases.each(plugin, lines, wanted, function(subject, case)
    cases.random_state(subject, case, 1)
    local before = inspect.files()
    answers.all(subject)
    local opened = inspect.files() - before
    if opened == 0 or told then return end
    told = true
    lines:wrong(("it opens files in a step: %d times in one evaluation"):format(opened),
      "read files in `create`; a step may come a million times")
  end)
end

-- A second instance in the same process, smaller and larger ones, and none any more, change nothing of the first.
local function first_case(plugin)
  for _, case in ipairs(cases.list(plugin)) do
    if case.setting and case.few then return case end
  end
end

local function others_come_and_go(plugin, lines)
  local case = first_case(plugin)
  local first = case and cases.open(plugin, case)
  if not first then return end
  local subject = inspect.open(first, plugin.name)
  cases.random_state(subject, case, 1)
  local alone, told = answers.all(subject), false
  local function compare(what)
    lines:at("%s, %s", case.name, what)
    local text = not told and answers.difference(alone, answers.all(subject))
    if not text then return end
    told = true
    lines:wrong(("it depends on another instance: %s"):format(text), "keep all data in the instance, no static variables")
  end
  local others = {}
  for _, count in ipairs { 40, 6 } do
    local other = cases.variant(case, cases.chain(count), plugin)
    lines:at("%s, beside an instance in a %s", case.name, other.shape.name)
    local run = cases.open(plugin, other)
    if run then
      others[#others + 1] = run
      compare(("after one in a %s was made"):format(other.shape.name))
      local second = inspect.open(run, plugin.name)
      cases.random_state(second, other, 2)
      answers.all(second)
      compare(("after one in a %s was asked"):format(other.shape.name))
      members.change(run, { 1, 3 }, {})
      compare(("after births and deaths in a %s"):format(other.shape.name))
    end
  end
  for _, run in ipairs(others) do
    inspect.destroy(run)
    compare("after another one was destroyed")
  end
end

function repeats.try(plugin, report)
  report:try("the same again later", function(lines) same_later(plugin, lines) end)
  report:try("it opens no files in a step", function(lines) opens_no_files(plugin, lines) end)
  report:try("other instances come and go", function(lines) others_come_and_go(plugin, lines) end)
end

return repeats
