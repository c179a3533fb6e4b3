-- hooke plugins [NAME]: the catalogue; of one plugin its parameters, units, formula and source.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local list, failed = hooke.catalogue()

local function parser_of()
  local p = argparse("hooke plugins", "What plugins there are: forces, constraints, integrators, outputs and all the others.")
  p:argument("name", "of one: its parameters, units, defaults, formula and source; of a kind: its plugins"):args("?")
  return p
end

local function default(p)
  if p.required then return "required" end
  if p.optional then return "-" end
  if p.type == "vector" then return ("{%g, %g, %g}"):format(p.initial[1], p.initial[2], p.initial[3]) end
  if p.type == "string" then return p.text ~= "" and p.text or "-" end
  if p.type == "boolean" then return tostring(p.initial[1] ~= 0) end
  if p.type == "choice" then
    local k = 0
    for word in p.text:gmatch("[^|]+") do
      if k == p.initial[1] then return word end
      k = k + 1
    end
  end
  if p.type == "function" then return "-" end
  local lists = { particles = true, edges = true, triangles = true, tetrahedra = true, numbers = true }
  if lists[p.type] then return "{}" end
  return ("%g"):format(p.initial[1])
end

local function range(p)
  if not p.min then return (p.type == "choice" or p.type == "function") and p.text or "" end
  return p.max <= p.min and (">= %g"):format(p.min) or p.max == math.huge and (">= %g"):format(p.min)
    or ("%g to %g"):format(p.min, p.max)
end

local function show(plugin)
  print(("%s '%s': %s"):format(plugin.kind, plugin.name, plugin.summary))
  if plugin.reference ~= "" then print("  source      " .. plugin.reference) end
  if plugin.order then
    print(("  order       %d, %d evaluations of f a step%s%s%s"):format(plugin.order, plugin.stages,
      plugin.symplectic and ", symplectic" or "", plugin.adaptive and ", adaptive" or "", plugin.implicit and ", implicit" or ""))
  end
  if plugin.facets ~= "" then print("  facets      " .. plugin.facets) end
  if plugin.periodic then print("  box         right in a periodic box, scene:periodic") end
  print("  file        " .. plugin.path)
  for _, p in ipairs(plugin.params) do
    print(("  %-11s %-12s %-9s default %-14s %s"):format(p.name, p.unit, p.type, default(p), p.help))
    local limits = range(p)
    if limits ~= "" or p.timed then
      print(("  %-11s %s"):format("", limits .. (p.timed and (limits ~= "" and "; " or "") .. "may be a function of t" or "")))
    end
  end
  if plugin.kind == "force" then print("  every force also takes label, only (ids) or group, from and to (s)") end
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
    show(plugin)
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
