-- The parts of a force: they add up to it, and each keeps to its own particles. Tried on scenes of several blocks and, where
-- there are elements between any particles, of several domains.
local inspect = require("inspect")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local parts = {}

local ROUNDING = 1e-12 -- of sums in another order, on particles with some dozen elements

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

local function add_up(plugin, lines)
  local sums, powers, base, written, used = worst.new(), worst.new(), base_case(plugin), nil, nil
  if not base then return end
  for _, shape in ipairs(shapes()) do
    local case = cases.variant(base, shape)
    lines:at("the parts of %s", case.name)
    local run = cases.open(plugin, case)
    if not run then return end
    local subject = inspect.open(run, plugin.name)
    cases.random_state(subject, case, 1)
    local whole, power = inspect.force(subject, 0, 0)
    local F, own, stray, stranger = inspect.parts(subject)
    written = written or (stray > 0 and ("%s: particle %d"):format(case.name, stray))
    used = used or (stranger > 0 and ("%s: the force on particle %d is not finite then"):format(case.name, stranger))
    local figure, text = worst.difference(F, whole)
    sums:take(figure, ("%s: %s"):format(case.name, text or ""))
    powers:take(math.abs(own - power) / math.max(1e-300, math.abs(power), math.abs(own)), case.name)
  end
  tell_of_strangers(lines, written, used)
  if used then return end -- the sums are not finite either
  lines:most("the parts add up to its force", sums.figure, ROUNDING,
    "every element is in the part hk_part_of once, with the force that `add` gives it", sums.where)
  lines:most("the parts add up to its power", powers.figure, 1e-9, "add the power of the part's own elements", powers.where)
end

function parts.try(plugin, report)
  if plugin.has.add_part then report:try("its parts", function(lines) add_up(plugin, lines) end) end
end

return parts
