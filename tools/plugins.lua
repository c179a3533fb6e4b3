-- hooke plugins [NAME]: the catalogue; of one plugin its parameters, units, formula and source.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local plugin_entry = require("common.handbook.plugin_entry")
local list, failed = hooke.catalogue()

local function parser_of()
  local p = argparse("hooke plugins", "What plugins there are: forces, constraints, integrators, outputs and all the others.")
  p:argument("name", "of one: its parameters, units, defaults, formula and source; of a kind: its plugins"):args("?")
  return p
end

-- Of all kinds, or of one: "force" or "forces".
local function of_kind(word)
  local found = {}
  for _, plugin in ipairs(list) do
    if not word or word == plugin.kind or word == plugin.kind .. "s" then found[#found + 1] = plugin end
  end
  return found
end

local function catalogue(plugins)
  local kind
  for _, plugin in ipairs(plugins) do
    if plugin.kind ~= kind then
      kind = plugin.kind
      print((plugin == plugins[1] and "" or "\n") .. kind)
    end
    print(("  %-18s %s"):format(plugin.name, plugin.summary))
  end
  if #plugins < #list then return end
  if #failed > 0 then print("\ncould not be loaded") end
  for _, f in ipairs(failed) do print(("  %s: %s"):format(f.path, f.reason)) end
end

local asked = command_line.parse("plugins", parser_of())
if not asked then return 1 end
local name = asked.name
if not name or #of_kind(name) > 0 then
  catalogue(of_kind(name))
  return 0
end
local names, found = {}, false
for _, plugin in ipairs(list) do
  names[#names + 1] = plugin.name
  if plugin.name == name then
    print(table.concat(plugin_entry.lines(plugin), "\n"))
    found = true
  end
end
if found then return 0 end
if name:find("/") or name:find("%.so$") then
  return command_line.complain("plugins", ("'%s' is a file: hooke check %s tries the plugin in it"):format(name,
    name:find("/") and name or "./" .. name))
end
local near = hooke.nearest(name, names)
return command_line.complain("plugins", ("there is no plugin '%s'%s"):format(name,
  near and ("; did you mean '%s'?"):format(near) or "; see: hooke plugins"))
