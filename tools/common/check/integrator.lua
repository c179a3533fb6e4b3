-- The tests of an integrator (hooke check), each in a process of its own: what it owes its host (integrator/habits.lua),
-- the lengths of its steps (integrator/steps.lua), and its order, stability and invariants (integrator/accuracy.lua).
local inspect = require("inspect")
local method = require("method")
local members = require("members")
local accuracy = require("common.check.integrator.accuracy")
local habits = require("common.check.integrator.habits")
local scenes = require("common.check.integrator.scenes")
local steps = require("common.check.integrator.steps")

-- hk_integrator.flags
local NEEDS_JACOBIAN, NEEDS_SOLVER, SPLITS, LIMITS_MOVES = 8, 32, 64, 128

local function starts(plugin, lines)
  lines:at("the scene 'swing'")
  local run, why = scenes.open(plugin, scenes.swing)
  if not run then error(why, 0) end
  local flags, grows, turns, constrained, tiles, keeps = method.flags(run)
  lines:value { flags = flags, grows = grows, turns = turns, constrained = constrained, tiles = tiles, keeps = keeps }
end

-- Checks the integrator that hooke.describe described; `path` and `given` are also fields of it.
return function(plugin, report)
  inspect.quiet()
  if plugin.scene then report:note("methods are tried in scenes made here alone: --scene is left aside") end
  function report.before(lines) -- the plugin's calls are named, its heap is counted
    inspect.watch(lines.fd, plugin.path)
    members.watch(lines.fd)
    method.watch(lines.fd)
  end
  local _, found = report:try("it starts", function(lines) starts(plugin, lines) end)
  if not found[1] then return end
  local flags = found[1].flags
  plugin.needs_jacobian, plugin.needs_solver = flags & NEEDS_JACOBIAN ~= 0, flags & NEEDS_SOLVER ~= 0
  plugin.splits, plugin.limits_moves = flags & SPLITS ~= 0, flags & LIMITS_MOVES ~= 0
  plugin.keeps_constraints = found[1].keeps
  plugin.constrained, plugin.tiles = found[1].constrained, found[1].tiles
  plugin.states_growth, plugin.states_turning = found[1].grows, found[1].turns
  for _, list in ipairs { habits.list, steps.list } do
    for _, property in ipairs(list) do
      report:try(property[1], function(lines) property[2](plugin, lines) end)
    end
  end
  accuracy.try(plugin, report)
end
