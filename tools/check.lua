-- hooke check PLUGIN.so [name=value ...]: whether a plugin is right: derivatives, energies, orders, memory, threads.
-- Each property is tried in a process of its own, N seconds at most for each of its scenes (default 20): a crash, a hang,
-- an exit and output are findings like a wrong figure. One line for each property, with the figure and its bound; below
-- one that is WRONG where it was seen, and what to do. The exit code is 1 when one is. name=value sets parameters of the
-- plugin; with --scene the plugin is checked as that script has it, beside the scenes made here; --only tries the
-- properties with TEXT in their name.
-- What there is to try of a kind is in common/check/KIND.lua.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local process = require("process")
local reports = require("common.check.report")

local function fail(message) return command_line.complain("check", message) end

local function parser_of()
  local p = argparse("hooke check", "Is this plugin right? One line for each property, with its figure and its bound.")
  p:argument("plugin", "the plugin's file, then name=value: parameters of the plugin"):args("*")
  p:option("--scene", "a script in which the plugin is checked as well")
  p:option("--seconds", "that each scene of a property may take"):default("20"):convert(command_line.positive("--seconds"))
  p:option("--only", "the properties with this text in their name")
  return p
end

-- The path, name=value as texts, options; nil: what is wrong has been said.
local function read_arguments()
  local asked = command_line.parse("check", parser_of())
  if not asked then return nil end
  local path, given, why = command_line.scene(asked.plugin)
  if not path then return fail(why or "no plugin given: hooke check PLUGIN.so [name=value ...]") and nil end
  asked.path, asked.given = path:find("/", 1, true) and path or "./" .. path, given
  return asked
end

-- The text of the command line as a value of that parameter; nil and why not.
local function value_of(p, text)
  if p.type == "string" or p.type == "choice" then return text end
  if p.type == "boolean" and (text == "true" or text == "false") then return text == "true" end
  if p.type == "vector" or p.type == "numbers" then
    local list = {}
    for number in text:gmatch("[^,]+") do list[#list + 1] = tonumber(number) end
    return list
  end
  if not tonumber(text) then return nil, ("%s: '%s' is not a number"):format(p.name, text) end
  return tonumber(text)
end

-- nil, or what is wrong with the numbers given.
local function beyond(p, value)
  for _, number in ipairs(type(value) == "table" and value or { value }) do
    if type(number) == "number" and p.min then
      local below = p.above_min and number <= p.min or number < p.min
      if below or number > p.max or number ~= number then
        return ("%s: %s%s is not %s %g%s"):format(p.name, tostring(number), p.unit ~= "" and " " .. p.unit or "",
          p.above_min and "above" or "at least", p.min, p.max < math.huge and (" and at most %g"):format(p.max) or "")
      end
    end
  end
end

local function read_given(plugin, texts)
  local known, given = {}, {}
  for _, p in ipairs(plugin.params) do known[#known + 1], known[p.name] = p.name, p end
  for name, text in pairs(texts) do
    if not known[name] then
      local near = hooke.nearest(name, known)
      return nil, ("%s has no parameter '%s'%s"):format(plugin.name, name,
        near and ("; did you mean '%s'?"):format(near) or "; it has " .. table.concat(known, ", "))
    end
    local why
    given[name], why = value_of(known[name], text)
    if given[name] == nil then return nil, why end
    why = beyond(known[name], given[name])
    if why then return nil, why end
  end
  return given
end

-- The file that is meant: one, or that of a plugin that is called so. nil and why there is none.
local function file_of(path)
  local file = io.open(path, "rb")
  local begin = file and file:read(4)
  if file then file:close() end
  if begin == "\127ELF" then return path end
  if file then return nil, path .. " is no shared object: build the plugin with cc -shared -fPIC, and check NAME.so" end
  local name, names = path:match("^%./([%w_]+)$"), {}
  for k, plugin in ipairs((hooke.catalogue())) do
    if plugin.name == name then return plugin.path end
    names[k] = plugin.name
  end
  local near = name and hooke.nearest(name, names)
  return nil, ("there is no file %s%s"):format(path, near and ("; did you mean the plugin '%s'?"):format(near) or "")
end

local asked = read_arguments()
if not asked then return 1 end
local meant, no_file = file_of(asked.path)
if not meant then return fail(no_file) end
asked.path = meant

local report, begun = reports.new(asked.seconds, asked.only), process.clock()
-- A file whose loading ends the process is a finding; one that is no plugin is wrong use.
local plugin, refused
local loads = report:try("it is loaded", function() hooke.describe(asked.path) end)
if loads then
  plugin, refused = hooke.describe(asked.path)
  if not plugin then return fail(refused) end
  if not package.searchpath("common.check." .. plugin.kind, package.path) then
    return fail(("%s is of the kind '%s', which cannot be checked"):format(asked.path, plugin.kind))
  end
  local why
  plugin.given, why = read_given(plugin, asked.given)
  if not plugin.given then return fail(why) end
  plugin.scene = asked.scene
  print(("%s '%s': %s"):format(plugin.kind, plugin.name, plugin.summary))
  if plugin.facets ~= "" then print("  its facets: " .. plugin.facets) end
  require("common.check." .. plugin.kind)(plugin, report)
  if report.tried == 0 and report.failed == 0 then
    return fail(asked.only and ("no property has '%s' in its name"):format(asked.only) or "nothing was tried")
  end
end
print(("%d of %d properties hold (%.1f s)"):format(report.lines - report.failed, report.lines, process.clock() - begun))
return report.failed > 0 and 1 or 0
