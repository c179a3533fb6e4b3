-- Reading a sweep script. It only describes a sweep, so it runs in an environment of its own, as scenes do: math,
-- string, table, require for modules beside it and in scripts/lib, and hooke.sweep, which marks the table it returns.
-- No files, no processes, no native code; an endless script is ended after a hundred million instructions.
local script = {}

local budget = 100000000

local harmless = { "assert", "error", "ipairs", "next", "pairs", "pcall", "select", "tonumber", "tostring", "type" }

local function copy(library)
  local t = {}
  for key, value in pairs(library) do t[key] = value end
  return t
end

local function environment(folder)
  local env = { math = copy(math), string = copy(string), table = copy(table), utf8 = copy(utf8) }
  env.string.dump = nil
  for _, name in ipairs(harmless) do env[name] = _G[name] end
  env.hooke = { version = hooke.version, sweep = function(t)
    if type(t) ~= "table" then error("hooke.sweep takes a table: hooke.sweep { scene = ... }", 2) end
    return setmetatable(t, { sweep = true })
  end }
  local loaded = {}
  function env.require(name)
    if loaded[name] ~= nil then return loaded[name] end
    if type(name) ~= "string" or not name:match("^[%w_-]+$") then
      error(("require: '%s' is not the name of a module"):format(tostring(name)), 2)
    end
    local chunk
    for _, place in ipairs { folder, hooke.library } do
      local path = ("%s/%s.lua"):format(place, name)
      local file = not chunk and io.open(path)
      if file then
        file:close()
        chunk = assert(loadfile(path, "t", env))
      end
    end
    if not chunk then error(("require: there is no module '%s' beside the sweep or in scripts/lib"):format(name), 2) end
    loaded[name] = chunk(name) or true
    return loaded[name]
  end
  return env
end

-- Whether a file is a sweep rather than a scene.
function script.is_sweep(text)
  return text:find("hooke%s*%.%s*sweep") ~= nil
end

local function limited(chunk)
  local thread = coroutine.create(chunk)
  local function stop() error("the script ran for a hundred million instructions: it does not end", 0) end
  debug.sethook(thread, stop, "", budget)
  return coroutine.resume(thread)
end

-- The definition that the script at `path` with this text returns.
function script.read(path, text)
  local folder = path:match("^(.*)/[^/]*$") or "."
  local name = path:match("[^/]*$")
  local chunk, message = load(text, "@" .. name, "t", environment(folder))
  if not chunk then error(message, 0) end
  local fine, definition = limited(chunk)
  if not fine then error(definition, 0) end
  if type(definition) ~= "table" or not (getmetatable(definition) or {}).sweep then
    error(name .. ": a sweep script ends with return hooke.sweep { scene = ... }", 0)
  end
  if definition.trust ~= nil then
    error(name .. ": trust: a script cannot lift the sandbox of its scenes; --trust on the command line can", 0)
  end
  definition.folder = folder
  return setmetatable(definition, nil)
end

return script
