-- ranges: the values that a parameter takes in a sweep. linear and log give plain lists; random, latin and normal describe
-- samples, which `draw` makes from a seed and the parameter's name: every parameter has a random stream of its own
-- (splitmix64), so its values do not change when another parameter is added. Latin hypercube: each of n equal strata of
-- the range contains one value, in shuffled order (McKay, Beckman and Conover, Technometrics 21, 1979). Of `normal` the range
-- is one standard deviation to each side of the mean (Box and Muller, Ann. Math. Stat. 29, 1958).
local ranges = {}

local most = 1000000

-- Rounds to 15 digits, so that 1000 is 1000 and not 999.9999999999998; whole numbers become integers.
local function rounded(x)
  local y = tonumber(("%.15g"):format(x))
  return math.tointeger(y) or y
end

local function check(what, from, to, count, scale)
  if type(from) ~= "number" or type(to) ~= "number" or not (from - from == 0 and to - to == 0) then
    error(what .. ": the ends of a range are two finite numbers", 3)
  end
  if math.type(count) ~= "integer" or count < 1 or count > most then
    error(("%s: the number of values is a whole number from 1 to %d, not %s"):format(what, most, tostring(count)), 3)
  end
  if from > to then
    error(("%s: from %.9g to %.9g is in reverse: the lesser end comes first"):format(what, from, to), 3)
  end
  if from == to and count > 1 then
    error(("%s: %d values from %.9g to %.9g are one and the same: two ends that differ, or one value"):format(what, count, from, to), 3)
  end
  if from < to and count == 1 and what ~= "random" and what ~= "latin" and what ~= "normal" then
    error(("%s: one value from %.9g to %.9g would be the first end alone: two values or more"):format(what, from, to), 3)
  end
  if scale ~= nil and scale ~= "log" and scale ~= "linear" then
    error(("%s: the scale is 'linear' or 'log', not '%s'"):format(what, scale), 3)
  end
  if scale == "log" and not (from > 0 and to > 0) then
    error(("%s: a logarithmic range from %g to %g: both ends must be above 0"):format(what, from, to), 3)
  end
end

-- The value at the fraction u (0 to 1) between from and to.
local function between(from, to, u, scale)
  if u == 0 then return rounded(from) end
  if u == 1 then return rounded(to) end
  if scale == "log" then return rounded(from * (to / from) ^ u) end
  return rounded(from + (to - from) * u)
end

local function spaced(from, to, count, scale)
  local list = { scale = scale }
  for k = 1, count do list[k] = between(from, to, count > 1 and (k - 1) / (count - 1) or 0, scale) end
  return list
end

-- `count` values from `from` to `to`, including both, in equal steps (log: with equal ratios).
function ranges.linear(from, to, count)
  check("linear", from, to, count)
  return spaced(from, to, count, "linear")
end

function ranges.log(from, to, count)
  check("log", from, to, count, "log")
  return spaced(from, to, count, "log")
end

-- `count` random values; scale "log": each decade has the same probability.
function ranges.random(from, to, count, scale)
  check("random", from, to, count, scale)
  return { sample = "random", from = from, to = to, count = count, scale = scale or "linear" }
end

function ranges.latin(from, to, count, scale)
  check("latin", from, to, count, scale)
  return { sample = "latin", from = from, to = to, count = count, scale = scale or "linear" }
end

-- Normally distributed: two thirds of the values lie between from and to; scale "log": their logarithms are.
function ranges.normal(from, to, count, scale)
  check("normal", from, to, count, scale)
  return { sample = "normal", from = from, to = to, count = count, scale = scale or "linear" }
end

local function round(x)
  return math.tointeger(math.floor(x + 0.5)) or x
end

-- The same range rounded to whole numbers, each once (samples keep repetitions).
function ranges.whole(range)
  local result, seen = {}, {}
  for key, value in pairs(range) do
    if type(key) == "string" then result[key] = value end
  end
  result.whole = true
  for _, x in ipairs(range) do
    local value = round(x)
    if not seen[value] then result[#result + 1] = value end
    seen[value] = true
  end
  return result
end

-- ---- drawing ----

local function stream(seed, name)
  local state = 0xCBF29CE484222325 ~ seed -- FNV-1a of the name
  for k = 1, #name do state = (state ~ name:byte(k)) * 0x100000001B3 end
  return function() -- from [0, 1)
    state = state + 0x9E3779B97F4A7C15
    local z = (state ~ (state >> 30)) * 0xBF58476D1CE4E5B9
    z = (z ~ (z >> 27)) * 0x94D049BB133111EB
    return ((z ~ (z >> 31)) >> 11) * 0x1p-53
  end
end

local function shuffled(count, uniform)
  local list = {}
  for k = 1, count do list[k] = k end
  for k = count, 2, -1 do
    local j = 1 + math.floor(uniform() * k)
    list[k], list[j] = list[j], list[k]
  end
  return list
end

-- A number from -infinity to infinity, of mean 0 and variance 1.
local function normal(uniform) return math.sqrt(-2 * math.log(1 - uniform())) * math.cos(2 * math.pi * uniform()) end

-- The values of a sample (random, latin, normal).
function ranges.draw(sample, seed, name)
  local uniform, list = stream(seed, name), { scale = sample.scale }
  local order = sample.sample == "latin" and shuffled(sample.count, uniform)
  for k = 1, sample.count do
    local u = sample.sample == "normal" and (1 + normal(uniform)) / 2 or uniform()
    if order then u = (order[k] - 1 + u) / sample.count end
    list[k] = between(sample.from, sample.to, u, sample.scale)
    if sample.whole then list[k] = round(list[k]) end
  end
  return list
end

-- ---- as text: "1,2,5", "1e2..1e6:log:9", "0..1:latin:50", "16..128:log:4:whole" ----

local kinds = { linear = "linear", lin = "linear", log = "log", random = "random", latin = "latin", normal = "normal" }

local function word_of(text, word, given)
  if kinds[word] == "log" then given.scale = "log"
  elseif kinds[word] == "linear" then given.scale = "linear"
  elseif kinds[word] then given.sample = word
  elseif word == "whole" then given.whole = true
  elseif word:match("^[-+]?%d+$") then given.count = math.tointeger(tonumber(word))
  else
    error(("'%s': '%s' is neither linear, log, random, latin, normal, whole nor a number of values"):format(text, word), 0)
  end
end

local function parse_range(text, from, to, rest)
  local given = {}
  for word in rest:gmatch("[^:]+") do word_of(text, word, given) end
  if not given.count then error(("'%s': how many values? For instance %s..%s:log:9"):format(text, from, to), 0) end
  local a, b = tonumber(from), tonumber(to)
  if not b then error(("'%s': '%s' is not a number"):format(text, to), 0) end
  local make = ranges[given.sample or given.scale or "linear"]
  local fine, range = pcall(make, a, b, given.count, given.sample and given.scale)
  if not fine then error(("'%s': %s"):format(text, (tostring(range):gsub("^.-:%d+: ", ""))), 0) end
  return given.whole and ranges.whole(range) or range
end

function ranges.parse(text)
  local from, to, rest = text:match("^(.-)%.%.([^:]*)(.*)$")
  if tonumber(from) then return parse_range(text, from, to, rest) end
  local list = {}
  for item in (text .. ","):gmatch("([^,]*),") do
    local value = tonumber(item)
    if value == nil then value = item end
    if value == "" then error(("'%s': a value between the commas is missing"):format(text), 0) end
    list[#list + 1] = value == "true" and true or value ~= "false" and value
  end
  return list
end

return ranges
