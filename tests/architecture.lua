-- The architecture: arrows between files run one way. An arrow goes from a file to one that it includes (#include), whose
-- symbol its object file takes (nm), or which it requires (Lua). Checked are the order of the rooms, circles of files,
-- the size of rooms, the one header of a room, the headers that a file of core/run sees, names that are defined twice,
-- retired words, who asks the processor, the lines that the loop links, and that core/ names no plugin. All findings are
-- printed, one a line. Every check is first run on a made-up example with planted faults, which it has to find.

local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
local source_graph = require("source_graph")

-- ---- what is allowed ----

-- The buildings of core/ and their rooms. An arrow goes from a room to itself or to one that comes before it here; the
-- contract, core/plugin.h and core/plugin/, comes before all.
local buildings = {
  { "engine", "text", "base", "contract", "host", "state", "blocks", "evaluate", "loop" },
  { "numerics", "functions", "stability", "matrix", "rigid", "constraints", "implicit", "sensitivity", "population", "step_choice" },
  { "scene", "scene", "meshes", "rigid" },
  { "run", "judge", "storage", "report", "run" },
  { "app", "script", "mesh_files", "shapes", "builders", "lua", "tools", "process", "options", "installation", "hooke", "command" },
}
local most_files = 20
-- Of what core/engine/loop/time_loop.c links, all it needs with it: what one has to read to know the loop.
local most_lines_linked = 4500
-- Of core/ beside the contract, that a file of core/run sees by its includes and by theirs.
local most_headers_seen = 15

-- Words that were metaphors or had several meanings, with the words in their place (core/README.md, "Words"). None is a
-- part of a file's name or of a name hk_x in C.
local retired_words = {
  aside = "fast subset, margin", alone = "uncoupled or isolated", bead = "point sprite", doubts = "contradictions",
  due = "the noun: births, releases", ink = "particle colour", lone = "uncoupled or isolated", look = "the verb: measure, find, survey",
  march = "step in tile", meeting = "contact, crossing", meetings = "contact candidates", mosaic = "view grid",
  nearby = "pair cache", passages = "encounters", reel = "film files", rerun = "comparison run", shelf = "documents",
  story = "page data", tell = "the verb: send, publish, update", told = "data, notes",
}

-- Headers beside a room's one header that other rooms may include: the commands' own, for their tests.
local further_headers = {}

-- Plugins that are called by an ordinary word: what the word means in core/.
local ordinary_words = {
  code = {
    table = "a table of Lua or of parameters", frames = "the frames of a run", field = "a row of a table of fields",
    neighbours = "the interface of that service, which is part of the ABI",
    checkpoint = "the file of a run that goes on", relax = "to give a processor a rest",
    midpoint = "the middle of a step", octree = "the interface of that service, which is part of the ABI",
    isosurface = "the interface of that service, which is part of the ABI",
    surface = "what a grid or a file of triangles spans", contact = "what surfaces and particles do that touch",
    membrane = "a sheet without resistance to bending", surfaces = "what contact keeps apart",
    volume = "of a body", solid = "what is not hollow", trajectory = "the positions of a run at its frames",
    hand = "to hand a thing over", csv = "the format of a table", pull = "the user's hand on a particle",
  },
  comment = {
    isosurface = "the interface of that service, which is part of the ABI",
    octree = "the tree of cells",
    neighbours = "particles, or entries of a list, beside each other",
    table = "a table of Lua or of parameters", frames = "the frames of a run", central = "central differences",
    field = "a member of a struct, or a row of a table of fields",
    midpoint = "the rule of integration", trapezoid = "the rule of integration", euler = "the method of the literature",
    bars = "rigid rods, the usual example of constraints", surface = "what a grid or a file of triangles spans",
    contact = "what surfaces and particles do that touch", barrier = "an energy that grows without bound",
    volume = "of a body", membrane = "a sheet without resistance to bending",
    surfaces = "what contact keeps apart", drag = "the resistance of the air",
    checkpoint = "the file of a run that goes on", trajectory = "the positions of a run at its frames",
    hand = "to hand a thing over, or what is written by hand", pull = "what springs and bars do",
    live = "what has not died", csv = "the format of a table",
  },
}

-- ---- rooms ----

local rank, rooms = { plugin = 0 }, 0
for _, building in ipairs(buildings) do
  for k = 2, #building do
    rooms = rooms + 1
    rank[building[1] .. "/" .. building[k]] = rooms
  end
end

local function room_of(path)
  if path == "core/plugin.h" or path:find("^core/plugin/") then return "plugin" end
  return path:match("^core/([%w_]+/[%w_]+)/")
end

-- Why an arrow is not allowed; nil: it is.
local function forbidden(from, to)
  local source, target = room_of(from), room_of(to)
  if source then
    if not target then return "core/ is below everything else" end
    if not rank[source] or not rank[target] then
      return ("the room %s is not in the list of rooms"):format(rank[source] and target or source)
    end
    if rank[target] > rank[source] then return ("%s is below %s"):format(source, target) end
  elseif from:find("^plugins/kit/") then
    if target ~= "plugin" and not to:find("^plugins/kit/") then return "the kit, which is installed, sees the ABI and itself only" end
  elseif from:find("^plugins/") then
    if target ~= "plugin" and not to:find("^plugins/common/") and not to:find("^plugins/kit/") then
      return "a plugin sees the ABI, plugins/kit and plugins/common only"
    end
  elseif from:find("^tools/native/") then
    if not target and not to:find("^tools/native/") and not to:find("^plugins/common/") and not to:find("^plugins/kit/") then
      return "a native module of tools sees core/, plugins/kit and plugins/common only"
    end
  elseif from:find("^tools/browser/") then
    if not (target or to:find("^tools/%a+/") or to:find("^plugins/common/")) then
      return "the page sees core/, plugins/common, native modules and tools/common only"
    end
  elseif from:find("^tools/common/") then
    if not (to:find("^tools/common/") or to:find("^tools/native/") or to:find("^scripts/lib/")) then
      return "tools/common sees native modules and scripts/lib only"
    end
  elseif from:find("^tools/") then
    if not (to:find("^tools/common/") or to:find("^tools/native/") or to:find("^scripts/lib/")) then
      return "a tool sees tools/common, native modules and scripts/lib only"
    end
  elseif from:find("^scripts/lib/") and not to:find("^scripts/lib/") then
    return "scripts/lib sees itself only"
  end
end

-- ---- checks: each takes what was read and returns a list of findings ----

local function against_order(arrows)
  local findings = {}
  for _, a in ipairs(arrows) do
    local why = forbidden(a.from, a.to)
    if why then findings[#findings + 1] = ("order: %s -> %s (%s): %s"):format(a.from, a.to, a.by, why) end
  end
  return findings
end

local function circles(arrows)
  local graph, files = source_graph.graph_of(arrows)
  local findings = {}
  for _, members in ipairs(source_graph.components(graph, files)) do
    findings[#findings + 1] = ("circle of %d files: %s; one way round: %s"):format(#members, table.concat(members, ", "),
      source_graph.circle_from(graph, members[1]))
  end
  return findings
end

-- Rooms are folders of core/, plugins/common/ and tools/common/; in plugins/KIND the folder is the list of plugins.
local function crowded(paths)
  local count, findings = {}, {}
  for _, path in ipairs(paths) do
    local folder = path:match("^(.*)/[^/]*$")
    if folder and (folder:find("^core") or folder:find("/common")) then count[folder] = (count[folder] or 0) + 1 end
  end
  for folder, n in pairs(count) do
    if n > most_files then findings[#findings + 1] = ("size: %s has %d files, %d are allowed"):format(folder, n, most_files) end
  end
  table.sort(findings)
  return findings
end

local function header_of(room) return ("core/%s/%s.h"):format(room, room:match("[^/]*$")) end

local function further_includes(includes)
  local by, findings = {}, {}
  for _, a in ipairs(includes) do
    local room = room_of(a.to)
    if room and room ~= "plugin" and room_of(a.from) ~= room and a.to ~= header_of(room)
      and not further_headers[a.to] then
      by[a.to] = by[a.to] or {}
      table.insert(by[a.to], a.from)
    end
  end
  for header, from in pairs(by) do
    table.sort(from)
    findings[#findings + 1] = ("header: %s is not the header of its room (%s), but included by %s"):format(header,
      header_of(room_of(header)), table.concat(from, ", "))
  end
  table.sort(findings)
  return findings
end

-- Files of core/run that see more headers of core/ than is allowed, the contract apart, by arrows of #include.
local function seeing_much(includes, most)
  local next_of, files, findings = {}, {}, {}
  for _, a in ipairs(includes) do
    if not next_of[a.from] then next_of[a.from], files[#files + 1] = {}, a.from end
    table.insert(next_of[a.from], a.to)
  end
  for _, file in ipairs(files) do
    if file:find("^core/run/.*%.c$") then
      local seen, list, count = {}, { file }, 0
      for _, from in ipairs(list) do
        for _, to in ipairs(next_of[from] or {}) do
          if not seen[to] then
            seen[to], list[#list + 1] = true, to
            if room_of(to) and room_of(to) ~= "plugin" then count = count + 1 end
          end
        end
      end
      if count > most then findings[#findings + 1] = ("headers: %s sees %d of core/, %d are allowed"):format(file, count, most) end
    end
  end
  table.sort(findings)
  return findings
end

-- The files whose objects a program gets that takes `file` from an archive: itself and what its symbols lead to.
local function linked(file, symbols)
  local next_of, seen, list = {}, { [file] = true }, { file }
  for _, a in ipairs(symbols) do
    next_of[a.from] = next_of[a.from] or {}
    table.insert(next_of[a.from], a.to)
  end
  for _, from in ipairs(list) do
    for _, to in ipairs(next_of[from] or {}) do
      if not seen[to] then seen[to], list[#list + 1] = true, to end
    end
  end
  return list
end

local function lines_of(list, text)
  local lines = 0
  for _, path in ipairs(list) do lines = lines + select(2, text[path]:gsub("\n", "")) end
  return lines
end

-- The names that an identifier has between its underscores, which is asked for once.
local names_in = {} -- by names, by identifier
local function names_of(identifier, names)
  names_in[names] = names_in[names] or {}
  local list = names_in[names][identifier]
  if not list then
    list = {}
    for _, name in ipairs(names) do
      if ("_" .. identifier .. "_"):find("_" .. name .. "_", 1, true) then list[#list + 1] = name end
    end
    names_in[names][identifier] = list
  end
  return list
end

-- Names of plugins in the text: as a word, or as a part of an identifier between underscores.
local function named(path, text, names)
  local findings, code, comment = {}, source_graph.split(text)
  for where, part in pairs { code = code, comment = comment } do
    local number = 0
    for line in (part .. "\n"):gmatch("(.-)\n") do
      number = number + 1
      local lower, seen = line:lower(), {}
      local function say(what)
        findings[#findings + 1] = ("name: %s:%d: %s in its %s"):format(path, number, what,
          where == "code" and "code" or "comments")
      end
      if lower:find("spring", 1, true) then say("a spring") end
      for identifier in lower:gmatch("[%w_]+") do
        for _, name in ipairs(names_of(identifier, names)) do
          if not ordinary_words[where][name] and not name:find("spring", 1, true) and not seen[name] then
            seen[name] = true
            say(("the plugin '%s'"):format(name))
          end
        end
      end
    end
  end
  table.sort(findings)
  return findings
end

-- Names that two headers or sources define: types (hk_x), include guards, and functions that headers declare. A guard that
-- stands twice hides the second header; a name with two meanings has to be looked up.
local defining = {
  type = { "\n}%s*(hk_[%w_]+);", "\n%f[%w]typedef%s+struct%s+(hk_[%w_]+)%s*{", "\nstruct%s+(hk_[%w_]+)%s*{" },
  guard = { "\n#ifndef%s+(HK_[%w_]+_H)%s" },
  ["function"] = { "\n[%w_][%w_ %*]-[ %*](hk_[%w_]+)%(" },
}

local function defined_twice(paths, text)
  local where, findings = {}, {}
  for _, path in ipairs(paths) do
    local is_header, code = path:find("%.h$"), text[path] and path:find("%.[ch]$") and "\n" .. source_graph.split(text[path]) or ""
    for what, patterns in pairs(defining) do
      for _, pattern in ipairs((is_header or what == "type") and patterns or {}) do
        for name in code:gmatch(pattern) do
          local key = what .. " " .. name
          where[key] = where[key] or {}
          where[key][path] = true
        end
      end
    end
  end
  for key, places in pairs(where) do
    local list = {}
    for path in pairs(places) do list[#list + 1] = path end
    table.sort(list)
    if #list > 1 then findings[#findings + 1] = ("twice: the %s is defined in %s"):format(key, table.concat(list, ", ")) end
  end
  table.sort(findings)
  return findings
end

-- Retired words between underscores in a file's name, or in names hk_x and HK_X of its code.
local function retired(path, text)
  local findings, seen = {}, {}
  local function check(name)
    if seen[name] then return end
    seen[name] = true
    for word in name:lower():gmatch("[^_%.]+") do
      if retired_words[word] then
        findings[#findings + 1] = ("word: %s: '%s' in %s is retired: %s"):format(path, word, name, retired_words[word])
        return
      end
    end
  end
  check(path:match("[^/]*$"))
  if text and path:find("%.[ch]$") then
    for name in source_graph.split(text):gmatch("%f[%w_][hH][kK]_[%w_]+") do check(name) end
  end
  return findings
end

-- One file asks the processor what vectors it has, and one knows how kinds of processors write them.
local function asks_the_processor(path, text)
  local findings = {}
  if path ~= "core/engine/base/processor.c" and text:find("__builtin_" .. "cpu_") then
    findings[1] = ("processor: %s asks the processor: hk_host.lanes has the answer"):format(path)
  end
  local includes = text:find("#%s*include <%w+intrin%.h>") or text:find("#%s*include <arm_%w+%.h>")
  if path ~= "core/plugin/vector_math.h" and includes then
    findings[#findings + 1] = ("processor: %s includes a header of one kind of processor: see core/plugin/vector_math.h"):format(path)
  end
  return findings
end

-- Functions of glibc that have other bits on arm64 than on x86-64, where those that `instead` has have the same.
local instead = { cbrt = "pow", hypot = "sqrt", exp2 = "ldexp or pow", erf = "a series", erfc = "a series", tgamma = "a series",
  lgamma = "a series" }

local function has_other_bits(path, text)
  local findings = {}
  if not path:find("^core/") and not path:find("^plugins/") then return findings end
  for name in source_graph.split(text):gmatch("%f[%w_]([%l%d]+)%(") do
    if instead[name] then
      findings[#findings + 1] = ("bits: %s calls %s, which differs between kinds of processors: take %s"):format(path, name,
        instead[name])
    end
  end
  return findings
end

-- ---- the checks find what is planted ----

local function check_the_checks()
  local function arrow(from, to) return { from = from, to = to, by = "planted" } end
  local good = { arrow("core/engine/loop/a.c", "core/engine/base/b.h"), arrow("core/engine/base/b.c", "core/engine/base/c.h"),
    arrow("core/engine/base/b.c", "core/engine/base/b.h"), arrow("plugins/forces/f.c", "core/plugin.h"),
    arrow("tools/run.lua", "tools/common/x/y.lua"), arrow("plugins/common/x/y.c", "plugins/kit/a.h"),
    arrow("plugins/kit/a.h", "core/plugin.h") }
  assert(#circles(good) == 0 and #against_order(good) == 0, "a graph without faults")
  local round = { arrow("core/engine/base/c.c", "core/engine/loop/a.h"), table.unpack(good) } -- a -> b -> c -> a through headers
  local found = circles(round)
  assert(#found == 1 and found[1]:find("circle of 3 files: core/engine/base/b, core/engine/base/c, core/engine/loop/a", 1, true), found[1])
  found = against_order(round)
  assert(#found == 1 and found[1]:find("core/engine/base/c.c -> core/engine/loop/a.h", 1, true), found[1])
  for _, bad in ipairs { arrow("plugins/forces/f.c", "core/engine/base/b.h"), arrow("plugins/forces/f.c", "plugins/forces/g.c"),
    arrow("core/engine/base/b.c", "plugins/common/x/y.h"), arrow("core/engine/base/b.c", "core/engine/attic/z.h"),
    arrow("tools/common/x/y.lua", "tools/run.lua"), arrow("scripts/lib/a.lua", "tools/common/x/y.lua"),
    arrow("tools/native/n.c", "plugins/forces/f.c"), arrow("plugins/kit/a.h", "plugins/common/x/y.h"),
    arrow("core/engine/base/b.c", "plugins/kit/a.h") } do
    assert(#against_order { bad } == 1, bad.from .. " -> " .. bad.to)
  end
  local way = { "core/plugin/a.h", "core/engine/loop/b.h", "core/numerics/matrix/c.h", "core/scene/scene/d.h", "core/run/judge/e.h",
    "core/app/lua/f.h" } -- from building to building
  for k = 2, #way do
    assert(#against_order { arrow(way[k], way[k - 1]) } == 0 and #against_order { arrow(way[k - 1], way[k]) } == 1, way[k])
  end

  local paths = {}
  for k = 1, most_files + 1 do paths[k] = ("core/engine/base/f%d.c"):format(k) end
  assert(#crowded(paths) == 1)
  paths[1] = "core/engine/host/f.c"
  assert(#crowded(paths) == 0)

  assert(#further_includes { arrow("core/engine/loop/a.c", "core/scene/scene/scene.h"),
    arrow("core/scene/scene/b.c", "core/scene/scene/c.h") } == 0)
  assert(#further_includes { arrow("core/engine/loop/a.c", "core/scene/scene/c.h") } == 1)

  assert(#linked("a.c", { arrow("a.c", "b.c"), arrow("b.c", "c.c"), arrow("d.c", "a.c"), arrow("c.c", "a.c") }) == 3)
  assert(lines_of({ "a.c", "b.c" }, { ["a.c"] = "int a;\nint b;\n", ["b.c"] = "int c;\n", ["c.c"] = "\n" }) == 3)

  assert(#retired("plugins/common/x/bead.c", "int hk_inked, look; /* hk_look */") == 1)
  assert(#retired("core/app/x/y.h", "void hk_watch_look(hk_watch_look *, int HK_LOOK_COST);") == 2)
  assert(#asks_the_processor("plugins/common/x/y.c", "#include <immintrin.h>\nif (__builtin_" .. "cpu_supports()") == 2)
  assert(#asks_the_processor("plugins/common/x/y.c", '#include "core/plugin/vector_math.h"') == 0)
  assert(#has_other_bits("plugins/common/x/y.c", "double r = hypot(a, b) + cbrt(c); /* erf(x) */ my_cbrt(c);") == 2)

  local text = '/* leapfrog */ int x = 1; // a\nf("rk4 /* pcg */"); int hk_pcg_size; /* "umfpack" */ int leapfrogs, a/b;\n'
  local code, comment = source_graph.split(text)
  assert(#code == #text and code:find('"rk4 /* pcg */"', 1, true) and not code:find("leapfrog ", 1, true))
  assert(code:find("a/b", 1, true) and comment:find('"umfpack"', 1, true) and not comment:find("rk4", 1, true))
  assert(#named("f.c", text, { "leapfrog", "rk4", "pcg", "umfpack" }) == 4)
  assert(#named("f.c", "int offspring; /* table */", { "table" }) == 1) -- a spring, but no table

  local seen = { { "core/run/run/a.c", "core/run/run/run.h" }, { "core/run/run/run.h", "core/engine/loop/loop.h" },
    { "core/run/run/a.c", "core/engine/loop/loop.h" }, { "core/run/run/a.c", "core/plugin.h" } }
  for k, pair in ipairs(seen) do seen[k] = { from = pair[1], to = pair[2] } end
  assert(#seeing_much(seen, 2) == 0 and #seeing_much(seen, 1) == 1)

  local twice = { ["a.h"] = "#ifndef HK_A_H\ntypedef struct hk_a {\n  int x;\n} hk_a;\nint hk_f(int);\n",
    ["b.h"] = "#ifndef HK_A_H\nstruct hk_a {\n  int y;\n};\nvoid *hk_f(void); /* } hk_b; */\n",
    ["c.c"] = "#include \"b.h\"\nvoid *hk_f(void) { return 0; }\n} hk_b;\nstruct hk_a use(hk_a);\n" }
  assert(#defined_twice({ "a.h", "b.h", "c.c" }, twice) == 3 and #defined_twice({ "a.h", "c.c" }, twice) == 0)

  local exists = { ["core/engine/base/b.h"] = true, ["core/engine/loop/c.h"] = true, ["tools/common/x/y.lua"] = true }
  found = source_graph.includes_of("core/engine/loop/a.c",
    '#include "core/engine/base/b.h"\n#include <core/x.h>\n#include "c.h"\n', exists)
  assert(#found == 2 and found[1].to == "core/engine/base/b.h" and found[2].to == "core/engine/loop/c.h")
  found = source_graph.requires_of("tools/run.lua", 'local y = require("common.x.y") -- require("common.x.y")\nrequire "cjson"', exists)
  assert(#found == 1 and found[1].to == "tools/common/x/y.lua")
  local lines = "o/core/a.o:                 U f\no/core/b.o:0000000000000000 T f\no/core/b.o:0000000000000010 t g\n"
    .. "o/core/a.o:                 U g\no/plugins/p.o:                 U f\n"
  found = source_graph.symbols_of(lines, function(object) return object:match("^o/(.*)o$") .. "c" end)
  assert(#found == 1 and found[1].from == "core/a.c" and found[1].to == "core/b.c" and found[1].by == "f")
end

-- ---- the house ----

local function output_of(command)
  local pipe = assert(io.popen(command))
  local text = pipe:read("a")
  assert(pipe:close(), command)
  return text
end

local function read(path)
  local file = assert(io.open(("%s/%s"):format(root, path)))
  local text = file:read("a")
  file:close()
  return text
end

local function house()
  local h = { paths = {}, exists = {}, text = {}, includes = {}, arrows = {}, plugins = {} }
  local listing = output_of(("cd '%s' && find core plugins tools scripts/lib -type f | LC_ALL=C sort"):format(root))
  for path in listing:gmatch("[^\n]+") do
    if path:find("%.[ch]$") or path:find("%.lua$") then
      h.paths[#h.paths + 1], h.exists[path] = path, true
      local name = path:match("^plugins/[%w_]+/([%w_]+)%.c$")
      if name then h.plugins[#h.plugins + 1] = name end
    end
  end
  for _, path in ipairs(h.paths) do
    if not path:find("^tools/templates/") then
      local is_lua = path:find("%.lua$") ~= nil
      h.text[path] = read(path)
      for _, a in ipairs((is_lua and source_graph.requires_of or source_graph.includes_of)(path, h.text[path], h.exists)) do
        h.arrows[#h.arrows + 1] = a
        if not is_lua then h.includes[#h.includes + 1] = a end
      end
    end
  end
  return h
end

-- The source of an object file; nil: the source is gone.
local function source_in(h)
  local known = {}
  return function(object)
    if known[object] == nil then
      local source = object:sub(#build + #"/obj/" + 1):gsub("o$", "c")
      known[object] = h.exists[source] and source or false
    end
    return known[object] or nil
  end
end

local function add_symbols(h)
  local objects = ("find '%s/obj/core' '%s/obj/plugins' '%s/obj/tools' -name '*.o'"):format(build, build, build)
  local lines, seen, source_of = output_of(objects .. " | xargs nm -A -g"), {}, source_in(h)
  for object in output_of(objects):gmatch("[^\n]+") do seen[source_of(object) or ""] = true end
  for _, path in ipairs(h.paths) do
    assert(seen[path] or not path:find("^core/.*%.c$"), path .. " was not compiled: make build")
  end
  h.symbols = source_graph.symbols_of(lines, source_of)
  table.move(h.symbols, 1, #h.symbols, #h.arrows + 1, h.arrows)
end

check_the_checks()
local h = house()
add_symbols(h)
local findings = {}
local function add(list) table.move(list, 1, #list, #findings + 1, findings) end
add(against_order(h.arrows))
add(circles(h.arrows))
add(crowded(h.paths))
add(further_includes(h.includes))
add(defined_twice(h.paths, h.text))
add(seeing_much(h.includes, most_headers_seen))
for _, path in ipairs(h.paths) do
  if path:find("^core/") then add(named(path, h.text[path], h.plugins)) end
  add(retired(path, h.text[path]))
  if path:find("%.[ch]$") and h.text[path] then
    add(asks_the_processor(path, h.text[path]))
    add(has_other_bits(path, h.text[path]))
  end
end
local loop = linked("core/engine/loop/time_loop.c", h.symbols)
local lines = lines_of(loop, h.text)
if lines > most_lines_linked then
  findings[#findings + 1] = ("lines: the loop links %d lines, %d are allowed"):format(lines, most_lines_linked)
end
print(("the loop links %d files of %d lines; the house has %d files, %d arrows"):format(#loop, lines, #h.paths, #h.arrows))
for _, finding in ipairs(findings) do print(finding) end
print(#findings == 0 and "passed" or ("%d findings"):format(#findings))
os.exit(#findings == 0)
