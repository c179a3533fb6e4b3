-- The parts of a force: they add up to it, and each keeps to its own particles. Tried on scenes of several blocks and, where
-- there are elements between any particles, of several domains.
local inspect = require("inspect")
local cases = require("common.check.force.cases")
local worst = require("common.check.force.worst")

local parts = {}

local ROUNDING = 1e-12 -- of sums in another order, on particles with some dozen elements

local function shapes() return { cases.chain(2500), cases.sheet(64, 130) } end

local function add_up(plugin, lines)
  local sums, powers, base, stray = worst.new(), worst.new(), nil, nil
  for _, case in ipairs(cases.list(plugin)) do
    if case.setting and case.few then base = base or case end
  end
  if not base then return end
  for _, shape in ipairs(shapes()) do
    local case = cases.variant(base, shape)
    lines:at("the parts of %s", case.name)
    local run = cases.open(plugin, case)
    if not run then return end
    local subject = inspect.open(run, plugin.name)
    cases.random_state(subject, case, 1)
    local whole, power = inspect.force(subject, 0, 0)
    local F, own, written = inspect.parts(subject)
    stray = stray or (written > 0 and ("%s: particle %d"):format(case.name, written))
    local figure, text = worst.difference(F, whole)
    sums:take(figure, ("%s: %s"):format(case.name, text or ""))
    powers:take(math.abs(own - power) / math.max(1e-300, math.abs(power), math.abs(own)), case.name)
  end
  lines:most("the parts add up to its force", sums.figure, ROUNDING,
    "every element belongs to the part hk_part_of, and is noted in `parts`; it reads its own particles only", sums.where)
  lines:most("the parts add up to its power", powers.figure, 1e-9, "add the power of the part's own elements", powers.where)
  if stray then
    lines:wrong("a part writes to a particle that it has not: " .. stray, "note all members of every element in `parts`")
  end
end

function parts.try(plugin, report)
  if plugin.has.add_part then report:try("its parts", function(lines) add_up(plugin, lines) end) end
end

return parts
