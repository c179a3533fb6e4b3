-- The reference of scenes (tools/common/handbook) names what the sources define, no more and no less: functions by the lists
-- luaL_Reg, keys by what hk_lua_check_keys lets pass. Its examples run, and `hooke help` finds its words.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tools/?.lua;%s/tests/support/?.lua;%s"):format(root, root, package.path)
local files = require("files")
local reference = require("common.handbook.reference")

local function read(path)
  local file = assert(io.open(root .. "/core/app/" .. path))
  local text = file:read("a")
  file:close()
  return text
end

local function output_of(format, ...)
  local pipe = assert(io.popen(format:format(...) .. " 2>&1"))
  local text = pipe:read("a")
  local _, _, code = pipe:close()
  return text, code or 0
end

local function quoted(text)
  local names = {}
  for name in text:gmatch('"([%w_]+)"') do names[#names + 1] = name end
  return names
end

-- Fails unless both have the same names.
local function compare(what, described, defined)
  local left = {}
  for _, name in ipairs(described) do left[name] = true end
  for _, name in ipairs(defined) do
    assert(left[name] ~= nil, ("%s: the sources have '%s', and tools/common/handbook does not"):format(what, name))
    left[name] = false
  end
  for name, unknown in pairs(left) do assert(not unknown, ("%s: nothing in the sources is called '%s'"):format(what, name)) end
end

-- ---- functions ----

-- The names of a list of luaL_Reg, the `number`-th of the file.
local function methods(path, number)
  local k = 0
  for body in read(path):gmatch("luaL_Reg [%w_]+%[%] = (%b{})") do
    k = k + 1
    if k == (number or 1) then return quoted(body) end
  end
  error(path .. " has no such list")
end

local function described(of)
  local names = {}
  for _, entry in ipairs(reference.all()) do
    local name = entry.name:match("^" .. of .. "[:.]([%w_]+)$")
    if name then names[#names + 1] = name end
  end
  return names
end

local scene = methods("lua/scene.c")
for _, list in ipairs { methods("builders/list.c"),
  { "force", "constraint", "corrector", "source", "integrator", "solver", "output", "service" } } do -- hk_kind_name
  table.move(list, 1, #list, #scene + 1, scene)
end
compare("a scene", described("scene"), scene)
compare("a run", described("run"), methods("lua/run.c"))
compare("a handle", described("handle"), methods("../app/script/handle.c"))
compare("a rigid body", described("rigid"), methods("builders/rigid.c"))
compare("a joint", described("joint"), methods("builders/joint_handle.c"))
local state = methods("lua/state.c")
table.move({ "t", "n" }, 1, 2, #state + 1, state)
compare("a state", described("state"), state)

-- ---- keys ----

local function keys_of(name)
  for _, entry in ipairs(reference.all()) do
    if entry.name == name then
      local names = {}
      for _, row in ipairs(entry.takes or {}) do
        if row.name ~= "CHANNEL" then names[#names + 1] = row.name end
      end
      return names
    end
  end
end

-- What the last list before each call of hk_lua_check_keys holds, by the name that the call has for errors.
local function checked_keys()
  local found = {}
  for path in output_of("cd '%s/core/app' && ls lua/*.c builders/*.c", root):gmatch("%S+") do
    local text = read(path)
    for at, arguments in text:gmatch("()hk_lua_check_keys(%b())") do
      local what, keys = arguments:match('"([%w_]+)", keys%)')
      local before = what and text:sub(1, at):match('.*keys%[%] = (%b{})')
      if before then keys = quoted(before) end
      if what and before and #keys > 0 then found[what] = keys end
    end
  end
  return found
end

local checked, count = checked_keys(), 0
checked.particle, checked.body = nil, nil -- those are read otherwise, and compared below
for what, keys in pairs(checked) do
  local of = keys_of("rigid:" .. what) or keys_of("scene:" .. what) or keys_of("hooke." .. what) or keys_of(what)
  assert(of, ("nothing describes the keys of '%s'"):format(what))
  if what ~= "implicit" then
    compare(what, of, keys)
    count = count + 1
  end
end
assert(count >= 15, ("only %d lists of keys were found"):format(count))
local body = {}
for name in read("builders/body.c"):match("struct shape {.-#undef"):gmatch('"([%w_]+)"[,}]') do body[name] = true end
for _, name in ipairs { "sphere", "box", "capsule", "cylinder", "plane", "mesh" } do body[name] = nil end
local list = {}
for name in pairs(body) do list[#list + 1] = name end
compare("body", keys_of("scene:body"), list)
list = quoted(read("shapes/implicit_shape.c"):match("hk_shape_keys%[HK_SHAPE_KEYS%] = (%b{})"))
local seen = {}
for name in read("builders/implicit.c"):match("common%[%] = .-none%[%]"):gmatch('"([%w_]+)"') do
  if not seen[name] then list[#list + 1], seen[name] = name, true end
end
compare("implicit", keys_of("scene:implicit"), list)

-- ---- what is said of commands is of commands that there are ----

local commands = {}
for name in output_of("'%s/hooke' --help", build):gmatch("\n  hooke ([%a_]+)") do commands[name] = true end
for name in assert(files.read(root .. "/scripts/handbook/commands.md")):gmatch("\n## ([^\n]+)") do
  assert(commands[name], "scripts/handbook/commands.md: there is no command " .. name)
  commands[name] = nil
end
for name in pairs(commands) do -- `hooke run` has pages of its own, and --watch is an option of it
  assert(name == "run" or name == "watch", "scripts/handbook/commands.md does not say what `hooke " .. name .. "` does")
end

-- ---- examples, help ----

local place = output_of("mktemp -d"):gsub("%s", "")
local script = {}
for _, entry in ipairs(reference.all()) do
  if entry.example then -- each in a function of its own, with a scene of its own
    script[#script + 1] = ("do local scene = hooke.scene {} %s end -- %s"):format(entry.example, entry.name)
  end
end
assert(#script > 25)
script[#script + 1] = "local scene = hooke.scene { duration = 0 } scene:particle {} return scene"
files.write(place .. "/examples.lua", table.concat(script, "\n"))
local said, code = output_of("'%s/hooke' run '%s/examples.lua' --no-output --quiet", build, place)
assert(code == 0, said)

local function help(word, wanted, expected)
  said, code = output_of("'%s/hooke' help %s", build, word)
  assert(code == expected and said:find(wanted, 1, true), ("hooke help %s: %d: %s"):format(word, code, said))
end

help("scene:grid", "nx           -          default required", 0)
help("pin", "scene:pin(ids", 0)
help("leapfrog", "integrator 'leapfrog'", 0)
help("restitution", "'restitution' is a parameter of:", 0)
help("sweep", "hooke sweep SWEEP.lua", 0)
help("stifness", "did you mean 'stiffness'?", 1)

-- What `hooke --help` says of a command is the first line of its tool, a whole sentence.
for name in output_of("ls '%s'/tools/*.lua", root):gmatch("[^\n]+") do
  local line = files.read(name):match("^[^\n]+")
  assert(line:find("%.$") or line:find("%. "), ("%s: its first line is no whole sentence: %s"):format(name, line))
end

-- The glossary: each word stands once, what it calls a name is known, and help answers for what hooke has not.
local words, names = {}, {}
for _, entry in ipairs(require("common.handbook.glossary").all(root .. "/scripts/handbook/glossary.md")) do
  for _, word in ipairs(entry.words) do
    assert(not words[word], word)
    words[word] = true
  end
  for name in entry.see:gmatch("`([%a_:.]+)`") do names[#names + 1] = name end
end
assert(words.verdict and #names > 80)
said, code = output_of("'%s/hooke' help %s", build, table.concat(names, " "))
assert(code == 0, said)
help("water", "see liquid", 0)
help("Verdicts", "see the page \"Why is my run not ok\"", 0)
help("textures", "there are no textures", 0)
help("tearing", "there is no fracture", 0)
help("stiffness", "'stiffness' is a parameter of:", 0) -- beside the word of the field
help("stiffness", "see lesson 7", 0)
os.execute(("rm -r '%s'"):format(place))
