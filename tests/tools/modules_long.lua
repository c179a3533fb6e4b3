-- What lies in the working folder, beside the scene or in folders that the environment names is no code of a tool's: every
-- command (the list is tools/*.lua) runs where a Lua file and a shared object of each module's name, programs, settings of
-- gnuplot and a three.js are planted, and none of them is loaded.
-- Under sanitizers what is loaded is the same there.
if assert(os.getenv("HK_BUILD"), "HK_BUILD"):find("sanitize") then os.exit(77) end
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
local files = require("files")

local function shell(format, ...)
  local pipe = assert(io.popen(format:format(...) .. " 2>&1"))
  local text = pipe:read("a")
  local _, how, code = pipe:close()
  return text, how == "signal" and 128 + code or code
end

local place = shell("mktemp -d /tmp/hooke-modules-XXXXXX"):gsub("%s", "")
local here, beside, named = place .. "/here", place .. "/scenes", place .. "/named"
local marks = place .. "/marks"

-- ---- what is planted ----

-- The modules that any file of the tools asks for, and those that a tool might.
local function modules()
  local list, seen = {}, {}
  local function add(name)
    if not seen[name] then list[#list + 1], seen[name] = name, true end
  end
  local text = shell("cat $(find '%s/tools' -name '*.lua')", root)
  for name in text:gmatch("require%s*%(?%s*[\"']([%w_.]+)[\"']") do add(name) end
  for _, name in ipairs { "lfs", "cjson", "cjson.safe", "process", "states", "page", "luasql.sqlite3" } do add(name) end
  return list
end

-- Of each name a file in Lua, and a shared object that leaves a file ESCAPED in the working folder.
local function path_of(folder, name) return ("%s/%s"):format(folder, (name:gsub("%.", "/"))) end

local function plant_objects(folder, names)
  local words = { "set -e" }
  for _, name in ipairs(names) do
    local path = path_of(folder, name)
    words[#words + 1] = ("mkdir -p '%s'; ln -s '%s/tests/fixtures/escape.so' '%s.so'"):format(path, build, path)
  end
  local script = place .. "/plant.sh"
  files.write(script, table.concat(words, "\n") .. "\n")
  local said, code = shell("sh '%s'", script)
  assert(code == 0, said)
end

local function plant_code(folder, name)
  local path = path_of(folder, name)
  local code = ("local f = io.open(%q, 'a') f:write(%q, '\\n') f:close() return {}"):format(marks, path)
  files.write(path .. ".lua", code)
  files.write(path .. "/init.lua", code)
end

local function plant_program(folder, name)
  files.write(("%s/%s"):format(folder, name), ("#!/bin/sh\necho program %s >>'%s'\n"):format(name, marks))
  shell("chmod +x '%s/%s'", folder, name)
end

local all = modules()
assert(#all > 40, "the modules of the tools are not found")
for _, folder in ipairs { here, beside, named } do
  plant_objects(folder, all)
  for _, name in ipairs(all) do plant_code(folder, name) end
  for _, name in ipairs { "gnuplot", "ffmpeg", "mkdir", "rm", "sh", "hooke" } do plant_program(folder, name) end
  files.write(folder .. "/.gnuplot", ("set print '%s' append; print 'gnuplot'\n"):format(marks))
  shell("mkdir -p '%s/node_modules/three/build'", folder)
  files.write(folder .. "/node_modules/three/build/three.min.js", "window.THREE = 'PLANTED';\n")
end
files.write(named .. "/init.lua", ("local f = io.open(%q, 'a') f:write('LUA_INIT\\n') f:close()"):format(marks))

local environment = {}
for _, version in ipairs { "", "_5_4" } do
  for variable, value in pairs { LUA_PATH = "?.lua;;", LUA_CPATH = "?.so;;" } do
    environment[#environment + 1] = ("%s%s='%s/%s'"):format(variable, version, named, value)
  end
  environment[#environment + 1] = ("LUA_INIT%s='@%s/init.lua'"):format(version, named)
end
environment[#environment + 1] = ("HOME='%s' XDG_CACHE_HOME='%s/cache' PATH=.::'../named:'\"$PATH\""):format(named, place)
environment = table.concat(environment, " ")

local function loaded()
  local text = (files.read(marks) or "") .. shell("find '%s' -name ESCAPED", place) .. shell("grep -rl PLANTED '%s'/*/out*", place)
    :gsub("grep:[^\n]*\n", "")
  os.remove(marks)
  shell("find '%s' -name ESCAPED -delete", place)
  return text
end

local failed = 0
local function expect(fine, format, ...)
  if fine then return end
  failed = failed + 1
  print(("failed: " .. format):format(...))
end

-- ---- the traps work ----

local lua = shell("command -v lua5.4 || command -v lua54 || command -v lua"):gsub("%s", "")
shell("cd '%s' && '%s' -e 'require \"lfs\"'", here, lua)
expect(loaded():find("here/lfs", 1, true), "Lua itself does not load what is planted in the working folder")
shell("cd / && env %s '%s' -e 'require \"page\"'", environment, lua)
local by_environment = loaded()
expect(by_environment:find("LUA_INIT", 1, true) and by_environment:find("named/page", 1, true),
  "Lua itself does not load what the environment names")
shell("cd '%s' && '%s' -e 'package.path = \"\" require \"process\"'", here, lua)
-- (One with sanitizers is loaded by programs with sanitizers alone.)
expect(loaded():find("ESCAPED", 1, true) or build:find("sanitize"), "Lua itself does not load the planted shared object")
shell("cd '%s' && env %s mkdir", here, environment)
expect(loaded():find("program mkdir", 1, true), "the shell does not start the planted programs")
if shell("command -v gnuplot") ~= "" then
  shell("cd '%s' && HOME='%s' gnuplot -e 'x = 1'", here, named)
  expect(loaded():find("gnuplot", 1, true), "gnuplot does not read the planted settings")
end

-- ---- every command ----

files.write(beside .. "/scene.lua", [[
local k = param("k", 100, "N/m")
local scene = hooke.scene { duration = 0.2, fps = 20 }
scene:particle { position = { 1, 0, 0 }, mass = 1 }
scene:force("central", { strength = k })
scene:output("trajectory", {})
scene:output("frames", { width = 32, height = 24, video = false })
return scene
]])
files.write(beside .. "/list.lua", 'return { width = 32, height = 24, columns = 1, { "../scenes/scene", at = 0.1 } }\n')
files.write(beside .. "/problem.lua", "return {}\n")

-- What each command does beside --help; what it does need not go well. A new one is called alone and with a scene.
local scene = "../scenes/scene.lua"
local more = {
  auto = { scene .. " --accuracy 1e-2 --budget 0.5" },
  bench = { scene .. " --budget 0.5 --out out/bench --integrators leapfrog,rk4" },
  check = { build .. "/plugins/forces/drag.so --only loaded" },
  convert = { "out/run --to csv" },
  docs = { "--annotations out/hooke.lua --quiet", "--manual out/hooke.7", "out/handbook --no-pictures --quiet" },
  explain = { scene, scene .. " --cost --out out/cost" },
  gallery = { "../scenes/list.lua --out out/gallery" },
  help = { "springs" },
  new = { "scene mine", "force mine" },
  paths = { scene .. " --integrators euler,rk4@0.05 --out out/paths" },
  plugins = { "", "springs" },
  refine = { scene .. " --of k --until 0.1" },
  scaling = { scene .. " k=10,20 --budget 0.5 --out out/scaling" },
  stability = { "--integrators leapfrog --out out/linear", scene .. " --integrators leapfrog --over k=100 --out out/limits" },
  sweep = { scene .. " k=10,20 --db out/s.db --quiet" },
  validate = { "--list", "oscillators --quick --out out/validate -j 1", "../scenes/problem.lua" },
  view = { scene, "out/run" },
  watch = { "nowhere.lua" },
}
local function try(words)
  local said, code = shell("cd '%s' && env %s '%s/hooke' %s </dev/null", here, environment, build, words)
  expect(code < 128, "hooke %s ended with %d: %s", words, code, said)
  local what = loaded()
  expect(what == "", "hooke %s loaded\n%s", words, what)
  return said, code
end

local said, code = try("run " .. scene .. " --out out/run")
expect(code == 0, "hooke run: %d: %s", code, said)
try("run nowhere.lua --watch")
try("run " .. scene .. " --integrator auto --accuracy 1e-2 --no-output")

local commands = 0
for name in shell("ls '%s'/tools/*.lua", root):gmatch("([%w_]+)%.lua\n") do
  commands = commands + 1
  try(name .. " --help")
  for _, words in ipairs(more[name] or { "", scene }) do try(name .. " " .. words) end
end
expect(commands >= 14, "%d commands are found", commands)

-- ---- relative folders of plugins ----

said, code = shell("cd '%s' && HOOKE_PLUGIN_PATH='%s:plugins' '%s/hooke' plugins", here, named, build)
expect(code == 1 and said:find("HOOKE_PLUGIN_PATH: 'plugins' is another folder wherever hooke is called", 1, true),
  "a relative folder of plugins: %d: %s", code, said)

shell("rm -rf '%s'", place)
os.exit(failed == 0)
