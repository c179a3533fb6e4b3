-- control: a function of time that `hooke optimise` finds, linear between values at equally spaced knots from 0 to `duration`
-- and constant afterwards:
--   local control = require("control")
--   local thrust = control("thrust", { knots = 31, duration = 2, help = "force on the cart, N" })
--   scene:force("field", { f = function(t) return thrust(t), 0, 0 end })
-- Its values are a parameter of the scene, the text "DURATION: VALUE VALUE ...", so that what was found can be run again by
-- any method: hooke run SCENE.lua thrust="2: 1 0.5 ...". `start`: the first guess, a number, a list, or function(t); 0.
local most = 10000

local function complain(name, format, ...) error(("control '%s': " .. format):format(name, ...), 4) end

local function finite(x) return type(x) == "number" and x - x == 0 end

local function check(name, options)
  if type(name) ~= "string" or type(options) ~= "table" then error("control(name, { knots =, duration = })", 4) end
  for key in pairs(options) do
    if key ~= "knots" and key ~= "duration" and key ~= "start" and key ~= "help" then complain(name, "there is no '%s'", tostring(key)) end
  end
  if math.type(options.knots) ~= "integer" or options.knots < 2 or options.knots > most then
    complain(name, "knots: a whole number from 2 to %d", most)
  end
  if not finite(options.duration) or options.duration <= 0 then complain(name, "duration: a positive number, s") end
end

local function initial(name, options)
  local start, list = options.start or 0, {}
  if type(start) == "table" and #start ~= options.knots then complain(name, "start: %d values for %d knots", #start, options.knots) end
  for k = 1, options.knots do
    local value = start
    if type(start) == "function" then value = start((k - 1) / (options.knots - 1) * options.duration) end
    if type(start) == "table" then value = start[k] end
    if not finite(value) then complain(name, "start: not a finite number at knot %d", k) end
    list[k] = ("%.17g"):format(value)
  end
  return ("%.17g: %s"):format(options.duration, table.concat(list, " "))
end

-- The values and the duration of a text; what is wrong with it is an error.
local function values_of(name, text)
  local duration, list = text:match("^%s*(%S+):%s*(.*)$")
  duration = tonumber(duration)
  if not finite(duration) or duration <= 0 then complain(name, "'%s' is not DURATION: VALUE VALUE ...", text:sub(1, 40)) end
  local values = {}
  for word in list:gmatch("%S+") do
    values[#values + 1] = tonumber(word)
    if not finite(tonumber(word)) then complain(name, "'%s' is not a finite number", word) end
  end
  if #values < 2 then complain(name, "two values at least") end
  return values, duration
end

return function(name, options)
  check(name, options)
  local values, duration = values_of(name, param(name, initial(name, options), options.help))
  local last = #values - 1
  return function(t)
    local at = t / duration * last
    local k = at < last and math.floor(at) or last - 1
    if at <= 0 then k, at = 0, 0 end
    local part = math.min(at - k, 1)
    return (1 - part) * values[k + 1] + part * values[k + 2]
  end
end
