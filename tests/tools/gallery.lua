-- A list for `hooke gallery` may be a stranger's: it is read in the sandbox and under the limits of scenes, its scenes run
-- under theirs, and nothing is written outside of --out.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
local files = require("files")

local pipe = assert(io.popen("mktemp -d"))
local folder = pipe:read("l")
pipe:close()

local function shell(format, ...) return os.execute(("cd %s && %s"):format(folder, format:format(...))) end

-- Runs hooke gallery on a list with this text -> its exit code, what it said.
local function gallery(text, words)
  files.write(folder .. "/lists/list.lua", text)
  local _, how, code = shell("timeout -k 5 200 %s/hooke gallery lists/list.lua %s >said 2>&1", build, words or "--out g")
  return how == "exit" and code or 128 + code, files.read(folder .. "/said")
end

local function refused(text, what)
  local code, said = gallery(text)
  assert(code == 1 and said:find(what, 1, true), ("exit %d: %s"):format(code, said))
end

local sizes = "width = 32, height = 24, columns = 1, "
assert(shell("mkdir lists lists/scenes elsewhere"))
files.write(folder .. "/elsewhere/ball.lua", [[
local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 1e-2 }
scene:particle { position = { 0, 0, param("z", 1) }, mass = 1 }
scene:output("table")
return scene
]])

-- ---- the list ----

refused("while true do end", "is there an endless loop?") -- of its instructions, or on a slow machine of its seconds
refused("io.open('stolen', 'w')", "is not available")
refused("return 3", "it has to return a table")
refused("return { width = 32 }", "height has to be a whole number above 0")
refused("return { " .. sizes .. "{ 'ball' } }", "'ball' has no moment")
refused("return { " .. sizes .. "{ '../..', at = 1 } }", "'../..' is no scene")
refused("return { " .. sizes .. "{ 'ball', at = 1 }, { '../elsewhere/ball', at = 1 } }", "ball stands twice")
refused("return { " .. sizes .. "{ 'ball', at = 1, param = { ['--trust'] = 1 } } }", "is no name = value")
refused("return { " .. sizes .. "{ 'ball', at = 1 }, film = { 'ball', at = 1, width = '1;touch x', fps = 1 } }",
  "film needs a width and fps")
assert(not shell("test -e stolen"))

-- ---- its scenes ----

local code, said = gallery("return { " .. sizes .. "{ '../elsewhere/ball', at = 0.5, param = { z = 3 } } }")
assert(code == 1 and said:find("made no pictures in g/ball/frames", 1, true), said)
assert(files.read(folder .. "/g/ball/table.csv"):find("\n0.5,"), said)
assert(shell("test \"$(ls elsewhere)\" = ball.lua"))
files.write(folder .. "/lists/scenes/endless.lua", "while true do end")
code, said = gallery("return { " .. sizes .. "{ 'endless', at = 0.5 } }")
assert(code == 1 and said:find("endless.lua did not come to t = 0.5 s", 1, true), said)

assert(shell("rm -rf %s", folder))
