-- The parts of a force: they add up to it, and each keeps to its own particles. Tried on scenes of several blocks and, where
-- there are elements between any particles, of several domains, also where the force acts on some particles only, after
-- births and deaths, and in a large scene.
local inspect = require("inspect")
local members = require("members")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local parts = {}

local ROUNDING, POWER_ROUNDING = 1e-12, 1e-9 -- of sums in another order, on particles with some dozen elements

local LARGE = 66000 -- particles
local SLOW = 0.02 -- s, of 10,000 particles by their parts: then that many, which may take 44 times as long, are not tried

local function shapes() return { cases.chain(2500), cases.sheet(64, 130) } end

local function base_case(plugin)
  for _, case in ipairs(cases.list(plugin)) do
    if case.setting and case.few then return case end
  end
end

-- What a part does with particles that it does not have is wrong whatever the sum is.
local function tell_of_strangers(lines, written, used)
  if written then
    lines:wrong("a part writes to a particle that it does not have", "note all members of every element in `parts`", written)
  end
  if used then
    lines:wrong("a part uses a particle that it does not have, which may not have been computed yet",
      "an element belongs to the part hk_part_of, that of its highest block; note all of its members in `parts`", used)
  end
end

-- The parts of what is open now against the whole.
local function compare(lines, found, run, plugin, case)
  local subject = inspect.open(run, plugin.name)
  cases.random_state(subject, { name = case.name, length = case.length, limits = case.limits }, 1)
  lines:at("%s", lines.place) -- the time that is allowed begins anew
  local whole, power = inspect.force(subject, 0, 0)
  local F, own, stray, stranger = inspect.parts(subject)
  lines:at("%s", lines.place)
  found.written = found.written or (stray > 0 and ("%s: particle %d"):format(lines.place, stray))
  found.used = found.used
    or (stranger > 0 and ("%s: the force on particle %d is not finite then"):format(lines.place, stranger))
  local figure, text = worst.difference(F, whole)
  found.sums:take(figure, ("%s: %s"):format(lines.place, text or ""))
  found.powers:take(math.abs(own - power) / math.max(1e-300, math.abs(power), math.abs(own)), lines.place)
  return subject
end

local function range(from, to)
  local list = {}
  for i = from, to do list[#list + 1] = i end
  return list
end

-- Of a scene of several blocks: as it is, and after births and deaths in several of them.
local function with_births(lines, found, plugin, case, options)
  lines:at("the parts of %s%s", case.name, options and ", acting on some particles" or "")
  local run = cases.open(plugin, case, options)
  if not run then return false end
  compare(lines, found, run, plugin, case)
  if case.shape.grid then
    inspect.destroy(run)
    return true -- of a chain is enough: a sheet takes long
  end
  local births = {}
  for k = 1, 700 do births[k] = { -0.5 * k, 0.3 * math.sin(k), 7 + 0.2 * math.cos(k) } end
  lines:at("the parts of %s%s, after births and deaths", case.name, options and ", acting on some particles" or "")
  members.change(run, range(90, 130), births)
  members.change(run, range(500, 503), {})
  lines:at("%s, all parts", lines.place)
  compare(lines, found, run, plugin, case)
  inspect.destroy(run)
  return true
end

-- What a small scene has shown need not be shown by a large one.
local function holds(found)
  return not (found.written or found.used) and found.sums.figure <= ROUNDING and found.powers.figure <= POWER_ROUNDING
end

-- More elements than a number of two bytes counts, unless the force takes long.
local function in_a_large_scene(lines, found, plugin, base)
  local case = cases.variant(base, cases.chain(LARGE))
  lines:at("the parts of %s", case.name)
  local run = cases.open(plugin, case)
  lines:at("%s", lines.place)
  if run then compare(lines, found, run, plugin, case) end
end

-- The least time of a processor of several sums by parts: other load can only increase it.
local function seconds_of(plugin, case)
  local run, least = cases.open(plugin, case), math.huge
  local subject = run and inspect.open(run, plugin.name)
  for _ = 1, subject and 5 or 0 do
    local begin = os.clock()
    inspect.parts(subject)
    least = math.min(least, os.clock() - begin)
  end
  return least
end

local function add_up(plugin, lines)
  local base, found = base_case(plugin), { sums = worst.new(), powers = worst.new() }
  if not base then return end
  for _, shape in ipairs(shapes()) do
    local case = cases.variant(base, shape)
    if not with_births(lines, found, plugin, case) then return end
    local some = {}
    for i = 1, #shape.positions do
      if i // 37 % 3 ~= 1 then some[#some + 1] = i end
    end
    with_births(lines, found, plugin, case, { only = some })
  end
  if holds(found) and seconds_of(plugin, cases.variant(base, cases.chain(10000))) < SLOW then
    in_a_large_scene(lines, found, plugin, base)
  end
  tell_of_strangers(lines, found.written, found.used)
  if found.used then return end -- the sums are not finite either
  lines:most("the parts add up to its force", found.sums.figure, ROUNDING,
    "every element is in the part hk_part_of once, with the force that `add` gives it", found.sums.where)
  lines:most("the parts add up to its power", found.powers.figure, POWER_ROUNDING, "add the power of the part's own elements",
    found.powers.where)
end

function parts.try(plugin, report)
  if plugin.has.add_part then report:try("its parts", function(lines) add_up(plugin, lines) end) end
end

return parts
