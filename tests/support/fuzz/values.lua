-- Random choices, and values as a script writes them: mostly what is asked for, now and then anything else.
local values = {}

function values.chance(p) return math.random() < p end
function values.pick(list) return list[math.random(#list)] end
local chance, pick = values.chance, values.pick

-- Of every so many values one is strange; 0: none.
values.strangeness = 0.03

local strange_numbers = { "0", "-1", "1", "0/0", "1/0", "-1/0", "1e308", "-1e308", "5e-324", "2^53", "2^31", "2^32", "2^63",
  "math.maxinteger", "math.mininteger", "1.5", "-0.0", "1e-300", "4294967295", "65536", "1e6", "1e-9" }

-- What a script of any type may hand over. s, h, e, r, p: a scene, a handle, edges, a run, an id; any may be nil.
local strange = { "nil", "true", "false", "''", "'x'", "'1'", "'\\xff\\0\\27[2J'", "('x'):rep(5000)", "'a\\nb'", "'%s%n'", "{}",
  "{ 1 }", "{ {} }", "{ 1, 2 }", "{ 1, 2, 3 }", "{ 1, 2, 3, 4 }", "{ { 1, 2 } }", "{ { 1, 2, 3 } }", "{ 0/0, 0, 0 }", "{ n = 1 }",
  "{ [1e9] = 1 }", "{ nil, 2 }", "{ '1', '2', '3' }", "print", "math.sin", "function() end", "function() return 1 end",
  "function(...) return ... end", "function() return {} end", "function() error('no') end", "function() return 0/0 end",
  "function(t) return t, t, t end", "coroutine.create(print)", "coroutine.wrap(function() coroutine.yield(1) end)", "s", "h", "e",
  "r", "p", "knot", "deep", "meta", "hooke", "hooke.scene", "_G", "string", "s.force", "h.at",
    "setmetatable({}, { __len = print })" }

function values.strange()
  return pick(chance(0.4) and strange_numbers or strange)
end

-- `text`, or now and then something strange.
function values.or_strange(text)
  return chance(values.strangeness) and values.strange() or text
end

local function one_of(p)
  local words = {}
  for word in (p.choices or "auto"):gmatch("[^|]+") do words[#words + 1] = word end
  return ("'%s'"):format(pick(words))
end

function values.number(low, high)
  if chance(values.strangeness) then return pick(strange_numbers) end
  return ("%.3g"):format(low + (high - low) * math.random())
end

function values.whole(low, high)
  return values.or_strange(tostring(math.random(low, high)))
end

function values.vector(size)
  local list = {}
  for k = 1, chance(values.strangeness) and math.random(0, 5) or 3 do list[k] = values.number(-size, size) end
  return values.or_strange(("{ %s }"):format(table.concat(list, ", ")))
end

-- Lists of ids of particles, of 1 to 20, where there mostly are so many.
local function tuples(arity)
  local list = {}
  for k = 1, math.random(0, 4) do
    local first, ids = math.random(1, 8), {}
    for c = 1, arity do ids[c] = values.or_strange(tostring(first + (c - 1) * (chance(0.95) and 1 or 0))) end
    list[k] = arity == 1 and ids[1] or ("{ %s }"):format(table.concat(ids, ", "))
  end
  return ("{ %s }"):format(table.concat(list, ", "))
end

values.tuples = tuples

local made = {
  integer = function(p) return tostring(math.random(math.tointeger(p.min) or 0, math.min(math.tointeger(p.max) or 20, 40))) end,
  boolean = function() return pick { "true", "false" } end,
  string = function() return pick { "'table.csv'", "'a/b.csv'", "'../b.csv'", "'/tmp/x'", "'heat'", "'strain'", "''", "'.'" } end,
  choice = one_of,
  vector = function() return values.vector(5) end,
  numbers = function() return pick { "{}", "{ 0, 1 }", "{ 1, 0 }", "{ 1, 2, 3 }" } end,
  particles = function() return chance(0.5) and "h:ids()" or tuples(1) end,
  edges = function() return pick { "h:edges()", "h:structural()", "e", "h:structural() .. h:shear()", tuples(2) } end,
  triangles = function() return chance(0.6) and "h:triangles()" or tuples(3) end,
  tetrahedra = function() return tuples(4) end,
}
made["per tuple"] = function()
  return chance(0.9) and values.number(0.1, 50) or ("{ %s, %s }"):format(values.number(0, 5), values.number(0, 5))
end

function made.number(p)
  local low = p.min or -10
  return values.number(low, math.max(low, math.min(p.max or 50, 50)))
end

-- The value of a parameter, as the catalogue describes it.
function values.of(p)
  local text = made[p.type](p)
  if p.timed and chance(0.3) then text = ("function(t) return %s end"):format(text) end
  return values.or_strange(text)
end

return values
