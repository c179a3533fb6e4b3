-- hooke check PLUGIN.so [name=value ...] [--scene FILE] [--seconds N] [--only TEXT]: is this plugin right? Each property
-- is tried in a process of its own, N seconds at most for each of its scenes (default 20): a crash, a hang, an exit and
-- output are findings like a wrong figure. One line for each property, with the figure and its bound; below one that is
-- WRONG where it was seen, and what to do. The exit code is 1 when one is. name=value sets parameters of the plugin; with
-- --scene the plugin is checked as that script has it, beside the scenes made here; --only tries the properties with TEXT
-- in their name.
-- What there is to try of a kind is in common/check/KIND.lua.
local command_line = require("common.run.command_line")
local process = require("process")
local reports = require("common.check.report")

local function fail(message) return command_line.complain("check", message) end

local options = { ["--scene"] = "scene", ["--seconds"] = "seconds", ["--only"] = "only" }

-- The command line: the path, name=value as texts, options; or nil and what is wrong with it.
local function read_arguments()
  local asked, k = { given = {}, seconds = "20" }, 0
  while k < #arg do
    k = k + 1
    local name, value = arg[k]:match("^([%a_][%w_]*)=(.*)$")
    local option = options[arg[k]]
    if name then asked.given[name] = value
    elseif option then
      k = k + 1
      if not arg[k] then return nil, arg[k - 1] .. " needs a value" end
      asked[option] = arg[k]
    elseif asked.path or arg[k]:sub(1, 1) == "-" then
      return nil, ("'%s' is neither the plugin nor name=value"):format(arg[k])
    else asked.path = arg[k]:find("/", 1, true) and arg[k] or "./" .. arg[k] end
  end
  if not asked.path then return nil, "no plugin given: hooke check PLUGIN.so [name=value ...]" end
  if not (tonumber(asked.seconds) and tonumber(asked.seconds) > 0) then
    return nil, ("--seconds: '%s' is not a time"):format(asked.seconds)
  end
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

local function read_given(plugin, texts)
  local known, given = {}, {}
  for _, p in ipairs(plugin.params) do known[#known + 1], known[p.name] = p.name, p end
  for name, text in pairs(texts) do
    if not known[name] then
      return nil, ("%s has no parameter '%s'; did you mean '%s'?"):format(plugin.name, name,
        hooke.nearest(name, known) or "")
    end
    local why
    given[name], why = value_of(known[name], text)
    if given[name] == nil then return nil, why end
  end
  return given
end

local asked, why = read_arguments()
if not asked then return fail(why) end

local report, begun = reports.new(tonumber(asked.seconds), asked.only), process.clock()
-- A file whose loading ends the process is a finding; one that is no plugin is wrong use.
local plugin, refused
local loads = report:try("it is loaded", function() hooke.describe(asked.path) end)
if loads then
  plugin, refused = hooke.describe(asked.path)
  if not plugin then return fail(refused) end
  if not package.searchpath("common.check." .. plugin.kind, package.path) then
    return fail(("%s is of the kind '%s', which cannot be checked"):format(asked.path, plugin.kind))
  end
  plugin.given, why = read_given(plugin, asked.given)
  if not plugin.given then return fail(why) end
  plugin.scene = asked.scene
  print(("%s '%s': %s"):format(plugin.kind, plugin.name, plugin.summary))
  require("common.check." .. plugin.kind)(plugin, report)
  if report.tried == 0 and report.failed == 0 then
    return fail(asked.only and ("no property has '%s' in its name"):format(asked.only) or "nothing was tried")
  end
end
print(("%d of %d properties hold (%.1f s)"):format(report.lines - report.failed, report.lines, process.clock() - begun))
return report.failed > 0 and 1 or 0
