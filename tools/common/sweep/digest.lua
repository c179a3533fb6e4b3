-- The data that a case's result depends on, as text and as a hash: the scene's text, the files and plugins that it
-- names, the engine. A file is identified by its bytes, not its date or path, so that the same case has the same key on
-- every host.
local lfs = require("lfs")

local digest = {}

-- 128 bits in two lanes of multiply, rotate and add, each finished by MurmurHash3's fmix64. The hash is not
-- cryptographic: sweep/store.lua compares the texts as well when two hashes are equal.
local function finish(h)
  h = (h ~ (h >> 33)) * 0xFF51AFD7ED558CCD
  h = (h ~ (h >> 33)) * 0xC4CEB9FE1A85EC53
  return h ~ (h >> 33)
end

function digest.of(text)
  local a, b = 0x9E3779B97F4A7C15 ~ #text, 0xC2B2AE3D27D4EB4F + #text
  local whole = #text - #text % 16
  local unpack = string.unpack
  for at = 1, whole, 16 do
    local x, y = unpack("<i8i8", text, at)
    a = ((a ~ x) * 0x9FB21C651E98DF25)
    a = ((a << 31) | (a >> 33)) + y
    b = ((b ~ y) * 0xA0761D6478BD642F)
    b = ((b << 29) | (b >> 35)) + (x ~ a)
  end
  local x, y = unpack("<i8i8", text:sub(whole + 1) .. ("\0"):rep(16), 1)
  a, b = finish((a ~ x) * 0x9FB21C651E98DF25 + y), finish((b ~ y) * 0xA0761D6478BD642F + x)
  return ("%016x%016x"):format(a + b, finish(b ~ (a << 1)))
end

local function read(path)
  local file = lfs.attributes(path, "mode") == "file" and io.open(path, "rb")
  if not file then return nil end
  local text = file:read("a")
  file:close()
  return text
end

-- Of hooke and its plugins, megabytes: the checksum that hooke itself computes (64 bits, core/app/tools/tool.c), and the
-- size. false: there is no such file.
local known = {}
function digest.file(path)
  if known[path] == nil then
    local sum = lfs.attributes(path, "mode") == "file" and hooke.checksum(path)
    known[path] = sum and ("%016x-%d"):format(sum, lfs.attributes(path, "size")) or false
  end
  return known[path]
end

-- ---- files and plugins that a scene names ----

-- Calls found(text) for every string of a Lua source that may be a name.
local function literals(source, found)
  for text in source:gmatch('"([^"\n]+)"') do found(text) end
  for text in source:gmatch("'([^'\n]+)'") do found(text) end
end

local function beside(path)
  return path:match("^(.*)/[^/]*$") or "."
end

-- The scene, and every file that a string in it names: modules that it requires, meshes, start states, and so on
-- through the modules; also returns the strings found. A name that the scene composes of parts is not found.
local function closure(scene)
  local files, order, names = {}, {}, {}
  local folder = beside(scene)
  local function visit(path, name)
    local text = not files[path] and read(path)
    if not text then return end
    files[path] = true
    order[#order + 1] = { name = name, path = path, text = text }
    if not path:match("%.lua$") then return end
    literals(text, function(word)
      names[word] = true
      for _, candidate in ipairs { folder .. "/" .. word, folder .. "/" .. word .. ".lua",
        hooke.library .. "/" .. word .. ".lua" } do
        visit(candidate, word)
      end
    end)
  end
  visit(scene, scene:match("[^/]*$"))
  return order, names
end

-- Whether a scene may use the plugin without naming it: the default integrator, and the solvers among which a run
-- chooses.
local function may_be_used(plugin, case)
  return plugin.kind == "solver" and not case.solver or plugin.kind == "integrator" and plugin.name == "leapfrog"
end

local function plugin_lines(plugins, names, case, lines)
  local chosen = {}
  for _, key in ipairs { "integrator", "solver" } do
    if case[key] then chosen[case[key]:match("^[^:]*")] = true end
  end
  for _, plugin in ipairs(plugins) do
    if names[plugin.name] or chosen[plugin.name] or may_be_used(plugin, case) then
      lines[#lines + 1] = ("plugin %s %s %s"):format(plugin.kind, plugin.name, digest.file(plugin.path))
    end
  end
end

-- The text of everything that a case with this scene, integrator and solver depends on; plugins: hooke.catalogue().
local grounds = {}
function digest.grounds(case, plugins)
  local key = table.concat({ case.scene, case.integrator or "", case.solver or "" }, "\0")
  if grounds[key] then return grounds[key] end
  local files, names = closure(case.scene)
  local lines = { ("hooke %s %s"):format(hooke.version, digest.file("/proc/self/exe") or "") }
  for k, file in ipairs(files) do
    lines[#lines + 1] = ("%s %s %s"):format(k == 1 and "scene" or "file", file.name, digest.of(file.text))
  end
  plugin_lines(plugins, names, case, lines)
  grounds[key] = table.concat(lines, "\n")
  return grounds[key]
end

return digest
