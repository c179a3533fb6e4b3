-- What tools say of their command lines, and of all that goes wrong: one sentence on standard error.
local command_line = {}

-- Prints "hooke: TOOL: TEXT"; gives the exit code for wrong use. What the text quotes may come from anywhere.
function command_line.complain(tool, text)
  io.stderr:write("hooke: ", hooke.plain(("%s: %s"):format(tool, text)), "\n")
  return 1
end

-- A text of JSON as a line on standard output: what could command a terminal is written as \u, which JSON means the same.
function command_line.print_json(text)
  io.write(text:gsub("[\xC2-\xF4][\x80-\xBF]+", function(character)
    if hooke.plain(character) == character or not utf8.len(character) then return character end
    return ("\\u%04x"):format(utf8.codepoint(character))
  end), "\n")
end

-- argparse's words as one sentence. It takes a number below 0 for an option.
local function sentence(text)
  local number = text:match("^unknown option '(%-%d[^']*)'")
  if number then return ("'%s' is taken for an option; the value of one is written --NAME=%s"):format(number, number) end
  return (text:gsub("\nDid you mean", "; did you mean"):gsub("\n", " "))
end

-- Parses the words, or arg; nil: the complaint is printed.
function command_line.parse(tool, parser, words)
  local fine, found = parser:pparse(words or arg)
  if fine then return found end
  found = sentence(found)
  command_line.complain(tool, ("%s; see: hooke %s --help"):format(found, tool))
end

-- The words of a scene and its parameters: its path, or nil where there is none, and a table; or nil, nil and why not.
function command_line.scene(words)
  local path, given = nil, {}
  for _, word in ipairs(words) do
    local name, value = word:match("^([%a_][%w_]*)=(.*)$")
    if name then given[name] = value
    elseif path then return nil, nil, ("'%s' is neither the scene nor name=value"):format(word)
    else path = word end
  end
  return path, given
end

-- The words o.scene of a tool become o.scene, o.params and, where none is named, o.out (out/TOOL/SCENE); true, or nil and why
-- not.
function command_line.take_scene(tool, o)
  local why
  o.scene, o.params, why = command_line.scene(o.scene)
  if not o.scene then return nil, why or "no scene is named" end
  o.out = o.out or ("out/%s/%s"):format(tool, o.scene:match("([^/]+)$"):gsub("%.lua$", ""))
  return true
end

-- Converters of argparse, which name their option where the text will not do.
function command_line.number(option)
  return function(text)
    local value = tonumber(text)
    if value and value - value == 0 then return value end
    return nil, ("%s: '%s' is not a number"):format(option, text)
  end
end

function command_line.positive(option)
  return function(text)
    local value = tonumber(text)
    if value and value > 0 and value < math.huge then return value end
    return nil, ("%s: '%s' is not a positive number"):format(option, text)
  end
end

function command_line.whole(option)
  return function(text)
    local value = math.tointeger(tonumber(text))
    if value and value >= 1 then return value end
    return nil, ("%s: '%s' is not a whole number above 0"):format(option, text)
  end
end

return command_line
