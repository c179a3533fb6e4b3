-- The tests of a force (hooke check), each in a process of its own. What they try is in force/: what every plugin owes
-- its host (habits), derivatives, claims, the further functions (further, internal, contact, parts), births and deaths (population).
local inspect = require("inspect")
local members = require("members")
local cases = require("common.check.force.cases")
local claims = require("common.check.force.claims")
local contact = require("common.check.force.contact")
local derivatives = require("common.check.force.derivatives")
local further = require("common.check.force.further")
local habits = require("common.check.force.habits")
local internal = require("common.check.force.internal")
local large = require("common.check.force.large")
local parts = require("common.check.force.parts")
local periodic = require("common.check.force.periodic")
local population = require("common.check.force.population")
local repeats = require("common.check.force.repeats")

local DEPENDS_ON_CHANNELS, STIFFENS = 8, 1024 -- hk_force.flags

-- Whether one scene at least takes the plugin with parameters made here; what it has beyond `add`.
local function starts(plugin, lines)
  local flags, has
  local accepted = {}
  cases.each(plugin, lines, nil, function(subject, case)
    accepted[case.name] = true
    flags, has = members.flags(subject)
  end)
  lines:value { flags = flags, has = has, accepted = accepted }
end

-- Checks the force that hooke.describe described; `path`, `given` and `scene` are also fields of it.
return function(plugin, report)
  inspect.quiet()
  function report.before(lines) -- the plugin's calls are named, its heap is counted
    inspect.watch(lines.fd, plugin.path)
    members.watch(lines.fd)
  end
  local fine, found = report:try("it starts", function(lines) starts(plugin, lines) end)
  if not found[1] then return fine end
  plugin.accepted = found[1].accepted
  plugin.has, plugin.on_y = found[1].has, found[1].flags & DEPENDS_ON_CHANNELS ~= 0
  plugin.flags = found[1].flags
  plugin.stiffens = found[1].flags & STIFFENS ~= 0
  for _, property in ipairs(habits.list) do
    report:try(property[1], function(lines) property[2](plugin, lines) end)
  end
  habits.instances(plugin, report)
  repeats.try(plugin, report)
  derivatives.try(plugin, report)
  claims.try(plugin, report)
  further.try(plugin, report)
  internal.try(plugin, report)
  contact.try(plugin, report)
  parts.try(plugin, report)
  periodic.try(plugin, report)
  population.try(plugin, report)
  large.try(plugin, report)
end
