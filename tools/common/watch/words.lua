-- The words of the command line of `hooke run ... --watch`, of which the run gets what is its own.
local words = {}

-- The run's words, the port of the page, and whether it shows each force by itself; nil and the reason.
function words.split(list)
  local own, port, forces, k = {}, 0, false, 1
  while list[k] do
    local word = list[k]
    local value = word:match("^%-%-port=(.*)$")
    if word == "--port" then
      k = k + 1
      value = list[k] or ""
    end
    if value then
      port = math.tointeger(tonumber(value))
      if not port or port < 0 or port > 65535 then return nil, ("--port: '%s' is not a number from 0 to 65535"):format(value) end
    elseif word == "--forces" then
      forces = true
    elseif word ~= "--watch" then
      own[#own + 1] = word
    end
    k = k + 1
  end
  return own, port, forces
end

-- The words with other values of parameters of the scene.
function words.with(list, values)
  local own = {}
  for _, word in ipairs(list) do
    local name = not word:find("^%-") and word:match("^([^=]+)=")
    if not (name and values[name]) then own[#own + 1] = word end
  end
  local names = {}
  for name in pairs(values) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do own[#own + 1] = ("%s=%s"):format(name, values[name]) end
  return own
end

return words
