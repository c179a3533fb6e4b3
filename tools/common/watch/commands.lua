-- What a page may ask for: JSON of a command, checked, as a table { name, ... }. Nothing else gets through to the run.
local cjson = require("cjson.safe")

local commands = {}

local function finite(x) return type(x) == "number" and x - x == 0 end

local function hold(t)
  local x = type(t.place) == "table" and t.place or {}
  local id = math.tointeger(t.id)
  if not (id and id > 0 and id < 2 ^ 32 and finite(x[1]) and finite(x[2]) and finite(x[3])) then return nil end
  local strength = finite(t.strength) and t.strength > 0 and t.strength or 1
  return { name = "hold", line = ("hold %d %.9g %.9g %.9g %.9g"):format(id, x[1], x[2], x[3], strength) }
end

local function pace(t)
  if not (finite(t.pace) and t.pace >= 0) then return nil end
  return { name = "pace", pace = t.pace, line = ("pace %.9g"):format(t.pace) }
end

-- Values of parameters that the scene declares, as texts; others are left out.
local function valued(what, t, declared)
  local values = {}
  for name, value in pairs(type(t.values) == "table" and t.values or {}) do
    local known = declared[name]
    if known and (type(value) == "string" or type(value) == "boolean" or finite(value)) then
      if known.type == "integer" then value = math.tointeger(value) or value end
      values[name] = finite(value) and math.type(value) == "float" and ("%.17g"):format(value) or tostring(value)
    end
  end
  return { name = what, values = values }
end

local function plain(name)
  return function() return { name = name, line = name } end
end

local function with_values(name)
  return function(t, declared) return valued(name, t, declared) end
end

local known = { hold = hold, pace = pace, start = with_values("start"), change = with_values("change"),
  release = plain("release"), pause = plain("pause"), go = plain("go"),
  step = plain("step"), stop = function() return { name = "stop" } end }

-- nil: it is none.
function commands.read(text, declared)
  local t = cjson.decode(text)
  local make = type(t) == "table" and known[t["do"]]
  return make and make(t, declared) or nil
end

return commands
