-- The command line of `hooke run ... --watch`: its own options, and the arguments that the run gets.
local command_line = {}

-- The run's arguments, the port of the page, whether it shows each force by itself, and whether the run begins without being
-- asked to; nil and the reason.
function command_line.split(list)
  local own, port, forces, at_once, k = {}, 0, false, false, 1
  while list[k] do
    local argument = list[k]
    local value = argument:match("^%-%-port=(.*)$")
    if argument == "--port" then
      k = k + 1
      value = list[k] or ""
    end
    if value then
      port = math.tointeger(tonumber(value))
      if not port or port < 0 or port > 65535 then return nil, ("--port: '%s' is not a number from 0 to 65535"):format(value) end
    elseif argument == "--forces" then
      forces = true
    elseif argument == "--at-once" then
      at_once = true
    elseif argument ~= "--watch" then
      own[#own + 1] = argument
    end
    k = k + 1
  end
  return own, port, forces, at_once
end

-- The arguments with other values of parameters of the scene.
function command_line.with(list, values)
  local own = {}
  for _, argument in ipairs(list) do
    local name = not argument:find("^%-") and argument:match("^([^=]+)=")
    if not (name and values[name]) then own[#own + 1] = argument end
  end
  local names = {}
  for name in pairs(values) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do own[#own + 1] = ("%s=%s"):format(name, values[name]) end
  return own
end

-- The arguments of a run that goes on from a checkpoint, with values of which those in `changed` are new.
function command_line.going_on(list, values, changed, checkpoint)
  local own, names = command_line.with(list, values), {}
  for k = #own, 1, -1 do
    local name = own[k]:match("^([^-=][^=]*)=")
    if name and changed[name] then table.remove(own, k) end
  end
  table.move({ "--resume", checkpoint }, 1, 2, #own + 1, own)
  for name in pairs(changed) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do table.move({ "--change", ("%s=%s"):format(name, changed[name]) }, 1, 2, #own + 1, own) end
  return own
end

-- The arguments as a shell would have them.
function command_line.text(list)
  local words = {}
  for k, word in ipairs(list) do
    words[k] = word:find("^[%w_+=:,./-]+$") and word or "'" .. word:gsub("'", "'\\''") .. "'"
  end
  return table.concat(words, " ")
end

return command_line
