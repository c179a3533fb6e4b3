-- The plugin contract as its authors see it: the page that a force or a method takes is short, every member of a table has
-- a shipped plugin that sets or uses it and code of the host that reads or fills it, and the examples of plugins/README.md
-- compile and pass `hooke check`. Each check is first run on a text with a planted fault.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")

local function read(path)
  local file = assert(io.open(path))
  local text = file:read("a")
  file:close()
  return text
end

local function list(command)
  local pipe, paths = assert(io.popen(command)), {}
  for path in pipe:lines() do paths[#paths + 1] = path end
  pipe:close()
  table.sort(paths)
  return paths
end

local function lines_of(text) return select(2, text:gsub("\n", "")) end

-- ---- members ----

-- Structs that plugins fill, whose members a plugin sets by `.name =`; the others are filled by the host.
local filled_by_plugins = { hk_param = true, hk_field = true, hk_plugin = true, hk_force = true, hk_constraint = true,
  hk_corrector = true, hk_source = true, hk_integrator = true, hk_solver = true, hk_output = true, hk_service = true, hk_facet = true,
  hk_fast_subset = true, hk_step = true }

local function without_comments(text) return (text:gsub("/%*.-%*/", "")) end

-- { { struct, member }, ... } of the tables in a header.
local function members(text)
  local found = {}
  for struct, body in without_comments(text):gmatch("struct (hk_[%w_]+) (%b{})") do
    local level = body:sub(2, -2):gsub("enum %b{}", "enum"):gsub("union (%b{});", function(inner) return inner:sub(2, -2) end)
    for line in level:gmatch("[^;]+") do
      local name = line:match("%(%*([%w_]+)%)")
      if name then
        found[#found + 1] = { struct, name }
      else
        for declared in (line:gsub("%b[]", "") .. ","):gmatch("([%w_]+)%s*,") do found[#found + 1] = { struct, declared } end
      end
    end
  end
  return found
end

local function is_filled_by_plugins(struct) return filled_by_plugins[struct] or struct:find("_facet$") ~= nil end

-- Members that rows and short structs give by position.
local by_position = { hk_param = { name = true, unit = true, help = true }, hk_field = { name = true },
  hk_facet = { id = true, table = true }, hk_fast_subset = { self = true, remove = true, remove_bound = true },
  hk_step = { h = true, h_next = true, error = true } }

local macros = {} -- by text
local function macros_of(plugins)
  if not macros[plugins] then
    local texts = {}
    for text in plugins:gmatch("#define HK_[%w_]+.-[^\\]\n") do texts[#texts + 1] = text end
    macros[plugins] = table.concat(texts, "\n")
  end
  return macros[plugins]
end

-- The names that stand behind a point or an arrow, or last in a list of arguments, read once for all members.
local uses = {} -- by text
local function named(text, name)
  if not uses[text] then
    uses[text] = {}
    for _, pattern in ipairs { "[%.>]([%w_]+)", ", ([%w_]+)%)" } do
      for found in text:gmatch(pattern) do uses[text][found] = true end
    end
  end
  return uses[text][name]
end

-- What plugins write into tables of that type: the texts between the braces of its constants, or of its facet's macro.
local kept = {} -- by struct
local function filled(plugins, struct)
  kept[plugins] = kept[plugins] or {}
  if kept[plugins][struct] then return kept[plugins][struct] end
  local texts, facet = {}, struct:match("^hk_([%w_]+)_facet$")
  if facet then
    for text in plugins:gmatch("HK_" .. facet:upper() .. "_FACET(%b())") do texts[#texts + 1] = text end
    for text in plugins:gmatch("hk_" .. facet .. "_facet [%w_]+%s*=%s*(%b{})") do texts[#texts + 1] = text end
  else
    for text in plugins:gmatch("%f[%w_]" .. struct .. " [%w_]+[%[%]%w_]*%s*=%s*(%b{})") do
      texts[#texts + 1] = text:gsub("HK_FACETS%b()", "")
    end
    texts[#texts + 1] = macros_of(plugins)
  end
  kept[plugins][struct] = table.concat(texts, "\n")
  return kept[plugins][struct]
end

-- Members of tables that plugins fill and no shipped plugin sets, or no code of the host reads, and members that the host
-- fills and no plugin uses; `size` comes first in all tables.
local function unused(headers, plugins, core)
  local findings = {}
  local function find(m, what) findings[#findings + 1] = ("%s.%s: %s"):format(m[1], m[2], what) end
  for _, header in ipairs(headers) do
    for _, m in ipairs(members(header)) do
      local struct, name = m[1], m[2]
      local ours = is_filled_by_plugins(struct)
      local by_macro = (by_position[struct] or {})[name] or name == "size" and struct:find("_facet$")
      if ours and not by_macro and not filled(plugins, struct):find("%." .. name .. "%s*=") then
        find(m, "no shipped plugin sets it")
      end
      if ours and name ~= "size" and not named(core, name) then find(m, "no code of the host reads it") end
      if not ours and not named(plugins, name) then find(m, "no shipped plugin uses it") end
    end
  end
  return findings
end

local function all_of(paths)
  local texts = {}
  for k, path in ipairs(paths) do texts[k] = without_comments(read(path)) end
  return table.concat(texts, "\n")
end

local planted = "struct hk_view {\n  int used, left;\n};\ntypedef struct hk_force {\n  size_t size;\n"
  .. "  int (*add)(void *self, int n); /* .never = */\n  int (*never)(void);\n  union { int a, b; };\n} hk_force;\n"
local found = unused({ planted }, "hk_force x = {.size = 1, .add = add, .a = 1, .b = 2, .facets = HK_FACETS(F(.never = 1))}; "
  .. "hk_solver y = {.never = f}; view->used", "f->add(); f->a + f->b")
assert(#found == 3 and found[1] == "hk_view.left: no shipped plugin uses it"
  and found[2] == "hk_force.never: no shipped plugin sets it" and found[3] == "hk_force.never: no code of the host reads it",
  table.concat(found, "; "))

local headers = {}
for _, path in ipairs(list(("find '%s/core/plugin' '%s/core/plugin.h' -name '*.h'"):format(root, root))) do
  if not path:find("/constraint.h$") then headers[#headers + 1] = read(path) end
end
local inline = without_comments(table.concat(headers, "\n")) -- functions in headers use members for plugins
-- core/numerics/stability sees a scene as methods do, through hk_system alone.
local users = "find '%s/plugins' '%s/core/numerics/stability' -name '*.[ch]'"
local plugins = all_of(list(users:format(root, root))) .. inline
local core = all_of(list(("find '%s/core' -name '*.[ch]' | grep -v '/core/plugin'"):format(root)))
found = unused(headers, plugins, core)
assert(#found == 0, table.concat(found, "\n"))

-- A force has at most 8 members.
local of_force = 0
for _, header in ipairs(headers) do
  for _, m in ipairs(members(header)) do if m[1] == "hk_force" then of_force = of_force + 1 end end
end
assert(of_force >= 5 and of_force <= 8, ("hk_force has %d members"):format(of_force))

-- ---- the first page ----

local most = 350
for what, header in pairs { force = "core/plugin/force.h", method = "core/plugin/integrator.h" } do
  local total = lines_of(read(root .. "/core/plugin.h")) + lines_of(read(("%s/%s"):format(root, header)))
  print(("the first page of the contract for a %s, core/plugin.h and %s: %d lines"):format(what, header, total))
  assert(total <= most, ("the first page of the contract has %d lines, %d are allowed"):format(total, most))
end

-- ---- the examples of the guide ----

-- Those that are whole plugins: { name, text }.
local function examples(guide)
  local found_here = {}
  for text in guide:gmatch("\n```c\n(.-)\n```") do
    local name = text:match("%.name = \"([%w_]+)\"")
    if name and text:find('#include "core/plugin.h"', 1, true) then found_here[#found_here + 1] = { name, text } end
  end
  return found_here
end

local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))

-- `options`: of hooke check.
local function passes(name, text, options)
  local file = assert(io.open(("%s/%s.c"):format(folder, name), "w"))
  file:write(text, "\n")
  file:close()
  local command = ("cd '%s' && cc -O2 -Wall -Wextra -Wpedantic -Werror -shared -fPIC $('%s/hooke' --cflags) %s.c -o %s.so"
    .. " >said 2>&1 && '%s/hooke' check ./%s.so %s >said 2>&1"):format(folder, build, name, name, build, name, options)
  return os.execute(command) and true or false, read(folder .. "/said")
end

local shown = examples(read(root .. "/plugins/README.md"))
assert(#shown >= 2, "the guide has two plugins at least")
for _, example in ipairs(shown) do
  local fine, said = passes(example[1], example[2], "")
  assert(fine, ("%s: %s"):format(example[1], said))
end
local fast = shown[#shown]
assert(fast[2]:find("add_part", 1, true) and fast[2]:find("HK_VERSIONS", 1, true) and fast[2]:find("jacobian", 1, true))
assert(lines_of(fast[2]) + 1 < 80, ("the fast force has %d lines"):format(lines_of(fast[2]) + 1))
local fine, said = passes(fast[1], (fast[2]:gsub("4 %* c%] %+= p", "4 * c] -= p")), "--only 'its Jacobian'")
assert(not fine and said:find("  WRONG ", 1, true), "a Jacobian of the wrong sign passes: " .. said)
os.execute(("rm -rf '%s'"):format(folder))
