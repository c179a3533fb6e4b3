-- What tools say of their command lines, and of all that goes wrong: one sentence on standard error.
local command_line = {}

-- Prints "hooke: TOOL: TEXT"; gives the exit code for wrong use. What the text quotes may come from anywhere.
function command_line.complain(tool, text)
  io.stderr:write("hooke: ", hooke.plain(("%s: %s"):format(tool, text)), "\n")
  return 1
end

-- Parses arg; nil: the complaint is printed.
function command_line.parse(tool, parser)
  local fine, found = parser:pparse(arg)
  if fine then return found end
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
