-- The tests of a service (hooke check): its interface has a name and a version, its table is there and stays where it is,
-- and a plugin that asks for it gets it.
local actors = require("actors")
local actor = require("common.check.actor")

local function has_a_version(plugin, lines, interface)
  local name, version = interface:match("^([%a_][%w_]*)/(%d+)$")
  if not name then
    return lines:wrong(("its interface '%s' is not like \"neighbours/1\""):format(interface), "name and version")
  end
  if name ~= plugin.name then
    lines:wrong(("its interface is %s and its name %s: `query` finds a service by its file"):format(interface, plugin.name),
      "give both the same name")
  end
  if tonumber(version) < 1 then lines:wrong("its version is below 1") end
end

local function serve(plugin, lines)
  for _, setting in ipairs(actor.settings(plugin)) do
    lines:at("%s", setting.name)
    local run = actor.scene(plugin, setting.values, { dt = 0.01 }):run { to = 0 }
    local interface = plugin.interface
    local fine, said = actors.serve(run, interface)
    if not fine then
      return lines:wrong("a plugin that asks for it gets nothing: " .. said,
        "`table` returns the address of the functions, after `create`")
    end
    local a = actors.open(run, "service")
    local one, two = actors.table(a), actors.table(a)
    if not one or one ~= two then
      lines:wrong("its table is not there, or elsewhere when it is asked again", "keep it in the instance")
    end
  end
end

return function(plugin, report)
  local try = actor.watched(plugin, report)
  plugin.interface = actors.interface(plugin.path)
  try("its interface has its name, and a version", function(l) has_a_version(plugin, l, plugin.interface) end)
  try("its table is there for those who ask", function(l) serve(plugin, l) end)
  actor.habits(plugin, try)
end
