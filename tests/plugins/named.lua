-- Every plugin is used: a force, constraint, corrector, source, integrator or solver is named by a scene of
-- scripts/scenes (or by what scenes share, scripts/lib), a problem of scripts/validation or a hard case of tests/hard; an
-- output by one of these or by a command; a service is asked for by another plugin, or by a builder of scenes. The
-- methods of the classic papers on cloth are named by a scene and by a problem. The folders are the lists. The search is
-- first run on planted lines.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
local files = require("files")

-- Kind of plugin -> folders in which one has to be named.
local scripts = { "scripts/scenes", "scripts/lib", "scripts/validation", "tests/hard" }
local places = { forces = scripts, constraints = scripts, correctors = scripts, sources = scripts, integrators = scripts,
  solvers = scripts, outputs = { "scripts/scenes", "tests/hard", "tools" },
  services = { "plugins/forces", "plugins/constraints", "plugins/correctors", "plugins/integrators", "plugins/outputs",
    "plugins/common", "core/app/builders" } }

-- Desbrun, Schroeder and Barr 1999; Baraff and Witkin 1998; Provot 1995; Bridson, Fedkiw and Anderson 2002; Baraff, Witkin
-- and Kass 2003.
local classic = { "desbrun", "baraff_witkin", "strain_limit", "impact_zones", "untangle" }

-- The Lua text without comments.
local function code_of(text) return (text:gsub("%-%-[^\n]*", "")) end

-- Whether the text names the plugin: in quotes; a service by its interface, "NAME/1".
local function names(text, name) return text:find("[\"']" .. name .. "[\"']") ~= nil end
local function asks(text, name) return text:find("\"" .. name .. "/%d") ~= nil end

local function text_of(folder)
  local list = {}
  for path in io.popen(("find %s/%s -name '*.lua' -o -name '*.[ch]'"):format(files.quoted(root), folder)):lines() do
    local text = files.read(path)
    list[#list + 1] = path:find("%.lua$") and code_of(text) or text
  end
  assert(#list > 0, folder .. " is empty")
  return table.concat(list, "\n")
end

local known = {}
local function named_in(folders, name, how)
  for _, folder in ipairs(folders) do
    known[folder] = known[folder] or text_of(folder)
    if how(known[folder], name) then return true end
  end
  return false
end

assert(names(code_of("scene:force(\"gravity\")"), "gravity") and names("integrator = 'euler'", "euler"))
assert(not names(code_of("-- scene:force(\"gravity\")"), "gravity") and not names("\"stoermer8\"", "stoermer"))
assert(asks("host->query(host, \"octree/1\")", "octree") and not asks("#include \"common/octree/1.h\"", "octree"))

local missing, count = {}, 0
for kind, folders in pairs(places) do
  for path in io.popen(("ls %s/plugins/%s/*.c"):format(files.quoted(root), kind)):lines() do
    local name = path:match("([%w_]+)%.c$")
    count = count + 1
    if not named_in(folders, name, kind == "services" and asks or names) then
      missing[#missing + 1] = ("%s/%s is named in none of %s"):format(kind, name, table.concat(folders, ", "))
    end
  end
end
for _, name in ipairs(classic) do
  if not named_in({ "scripts/scenes", "scripts/lib" }, name, names) then missing[#missing + 1] = name .. " has no scene" end
  if not named_in({ "scripts/validation" }, name, names) then missing[#missing + 1] = name .. " has no problem" end
end
table.sort(missing)
for _, line in ipairs(missing) do print(line) end
print(("%d plugins, %d missing"):format(count, #missing))
os.exit(#missing == 0 and count > 60)
