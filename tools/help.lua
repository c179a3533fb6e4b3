-- hooke help WORD: what a word is: a command, a function of scenes, a plugin, a parameter, a word of the field.
local argparse = require("argparse")
local command_line = require("common.run.command_line")
local glossary = require("common.handbook.glossary")
local lfs = require("lfs")
local plugin_entry = require("common.handbook.plugin_entry")
local reference = require("common.handbook.reference")

local function parser_of()
  local p = argparse("hooke help", "What a word is: a command, a function of scenes, a plugin, a word of the field, or what "
    .. "takes a parameter of that name.")
  p:argument("word", "such as grid, scene:pin, springs, leapfrog, stiffness; or several"):args("*")
  return p
end

local function say(lines) print(table.concat(lines, "\n") .. "\n") end

-- Who takes a parameter of that name.
local function takers(word, plugins)
  local lines = {}
  local function add(of, row, unit, text)
    if row == word then lines[#lines + 1] = ("  %-28s %-10s %s"):format(of, unit, text) end
  end
  for _, entry in ipairs(reference.all()) do
    for _, row in ipairs(entry.takes or {}) do add(entry.name, row.name, row.unit, row.text) end
  end
  for _, plugin in ipairs(plugins) do
    for _, p in ipairs(plugin.params) do add(plugin.kind .. " " .. plugin.name, p.name, p.unit, p.help) end
  end
  if #lines > 0 then table.insert(lines, 1, ("'%s' is a parameter of:"):format(word)) end
  return lines
end

local function commands()
  local names = { "run" }
  for file in lfs.dir(hooke.folder) do names[#names + 1] = file:match("^([%a_]+)%.lua$") end
  return names
end

local function unknown(word, plugins)
  local names, is_command = commands(), {}
  for _, name in ipairs(names) do is_command[name] = true end
  local function add(name, rows)
    names[#names + 1] = name
    for _, row in ipairs(rows or {}) do names[#names + 1] = row.name end
  end
  for _, entry in ipairs(reference.all()) do
    add(entry.name, entry.takes)
    add(entry.name:match("[%w_]+$"))
  end
  for _, plugin in ipairs(plugins) do add(plugin.name, plugin.params) end
  for _, entry in ipairs(glossary.all()) do table.move(entry.words, 1, #entry.words, #names + 1, names) end
  local near = hooke.nearest(word, names)
  return command_line.complain("help", ("%s '%s'%s"):format(is_command[near] and "unknown command" or "nothing is called", word,
    near and ("; did you mean '%s'?"):format(near) or "; see: hooke --help, hooke plugins"))
end

-- What is known of the word; the exit code.
local function explain(word, plugins)
  local found = false
  for _, entry in ipairs(reference.find(word)) do
    say(reference.lines(entry))
    found = true
  end
  for _, plugin in ipairs(plugins) do
    if plugin.name == word then
      say(plugin_entry.lines(plugin))
      found = true
    end
  end
  local lines, known = takers(word, plugins), glossary.find(word)
  if #lines > 0 then say(lines) end
  if known then say(glossary.lines(known)) end
  return (found or #lines > 0 or known) and 0 or unknown(word, plugins)
end

local asked = command_line.parse("help", parser_of())
if not asked then return 1 end
if #asked.word == 0 then return command_line.complain("help", "of what? hooke help WORD, or hooke --help for the commands") end
local plugins, code = hooke.catalogue(), 0
for _, word in ipairs(asked.word) do code = math.max(code, explain(word, plugins)) end
return code
