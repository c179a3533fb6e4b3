-- The annotations for Lua's language server, `hooke docs --annotations`: each line follows the grammar of LuaCATS, every name of a
-- class is defined, no key or argument is left open, and each parameter of each plugin has a type. Where lua-language-server is
-- installed, it finds no fault.
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD")

local function output_of(format, ...)
  local pipe = assert(io.popen(format:format(...) .. " 2>&1"))
  local text = pipe:read("a")
  return text, select(3, pipe:close())
end

local place = output_of("mktemp -d"):gsub("%s", "")
local said, code = output_of("'%s/hooke' docs --annotations '%s/hooke.d.lua'", build, place)
assert(code == 0, said)
local lines = {}
for line in io.lines(place .. "/hooke.d.lua") do lines[#lines + 1] = line end
assert(loadfile(place .. "/hooke.d.lua", "t"), "it is not Lua")

-- ---- the grammar of types: union = one {"|" one}; one = base {"[]"} ----

local named, union = {}, nil

local function skip(text, at) return text:match("^ *()", at) end

-- Parameters of fun(...), from behind the parenthesis.
local function parameters(text, at)
  while text:sub(at, at) ~= ")" do
    local after = text:match("^[%a_][%w_]*%??()", at) or text:match("^%.%.%.()", at)
    assert(after, "a parameter is expected: " .. text:sub(at))
    if text:sub(after, after) == ":" then after = union(text, skip(text, after + 1)) end
    at = skip(text, text:sub(after, after) == "," and after + 1 or after)
  end
  at = at + 1
  if text:sub(at, at) ~= ":" then return at end
  repeat
    at = union(text, skip(text, at + 1))
  until text:sub(at, at) ~= ","
  return at
end

local function one(text, at)
  local after = text:match("^fun%(()", at)
  if after then return parameters(text, after) end
  after = text:match('^"[^"]*"()', at)
  if not after then
    local name
    name, after = text:match("^([%a_][%w_.]*)()", at)
    assert(name, "a type is expected: " .. text:sub(at))
    named[name] = true
  end
  while text:sub(after, after + 1) == "[]" do after = after + 2 end
  return after
end

function union(text, at)
  at = one(text, at)
  while text:sub(at, at) == "|" do at = one(text, at + 1) end
  return at
end

local function whole_type(text)
  local at = union(text, 1)
  assert(text:sub(at) == "" or text:sub(at):find("^ #"), "what is behind the type: " .. text:sub(at))
end

local tags = {
  meta = function(rest) assert(rest == "") end,
  class = function(rest) assert(rest:find("^[%a_][%w_.]*$")) end,
  field = function(rest) whole_type(assert(rest:match("^[%a_][%w_]*%?? (.*)$"))) end,
  param = function(rest) whole_type(assert(rest:match("^[%a_][%w_]*%?? (.*)$"))) end,
  ["return"] = whole_type,
  overload = function(rest) whole_type(assert(rest:match("^fun%(.*$"))) end,
}

local defined, fields, class = {}, {}, nil
for _, name in ipairs { "any", "boolean", "function", "integer", "number", "string", "table" } do defined[name] = true end
for k, line in ipairs(lines) do
  local tag, rest = line:match("^%-%-%-@(%a+) ?(.*)$")
  if tag then
    local fine, why = pcall(assert(tags[tag], line), rest)
    assert(fine, ("line %d: %s: %s"):format(k, line, why))
    if tag == "class" then
      assert(not defined[rest], rest .. " is there twice")
      class, defined[rest], fields[rest] = rest, true, {}
    elseif tag == "field" then
      local name = rest:match("^[%w_]+")
      assert(not fields[class][name], ("%s.%s is there twice"):format(class, name))
      fields[class][name] = true
    end
  end
end
for name in pairs(named) do assert(defined[name], "nothing defines the type " .. name) end

-- ---- what the catalogue has: `hooke plugins` ----

local count = 0
for line in output_of("'%s/hooke' plugins", build):gmatch("[^\n]+") do
  local kind, name = line:match("^(%a+)$"), line:match("^  (%S+)")
  if kind then class = kind end
  if name then
    local own = assert(fields[("hooke.%s.%s"):format(class, name)], ("%s %s has no class"):format(class, name))
    if count % 8 == 0 then -- of every eighth each parameter, by its own page
      for parameter in output_of("'%s/hooke' plugins %s", build, name):gmatch("\n  ([%w_]+) [^\n]- default ") do
        assert(own[parameter], ("%s has no %s"):format(name, parameter))
      end
    end
    count = count + 1
  end
end
assert(count > 100, count)
local text = table.concat(lines, "\n")
for _, wanted in ipairs { '@overload fun(self: hooke.Scene, name: "springs", parameters?: hooke.force.springs)',
  '---@field up? "z"|"y" # ', "---@field edges integer[]|integer[][] # " } do
  assert(text:find(wanted, 1, true), wanted)
end

-- What the language itself defines has a type: keys of tables and arguments of functions. (What is given back may be anything.)
for _, line in ipairs(lines) do
  assert(not line:find("^%-%-%-@field [%w_]+%?? any") and not line:find("^%-%-%-@param [%w_]+%?? any"), line)
end

if output_of("command -v lua-language-server") ~= "" then
  said, code = output_of("lua-language-server --check '%s' --checklevel=Warning", place)
  assert(code == 0, said)
end
os.execute(("rm -r '%s'"):format(place))
