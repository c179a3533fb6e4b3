-- Recordings from strangers: `convert` and `view` refuse each that foreign_recordings.py makes with one sentence, show
-- nothing of other files, follow no link that lies in the folder, and wait for no pipe.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
local files = require("files")

local python
for _, name in ipairs { "python3", "/usr/bin/python3" } do
  if not python and os.execute(name .. " -c 'import h5py, numpy' 2>/dev/null") then python = name end
end
if not python then
  print("skipped: there is no h5py")
  os.exit(77)
end

local pipe = assert(io.popen("mktemp -d"))
local folder = pipe:read("l")
pipe:close()

local function shell(format, ...) return os.execute(("cd %s && %s"):format(folder, format:format(...))) end

-- Runs hooke with a limit of time -> its exit code, what it said.
local function hooke(format, ...)
  local _, how, code = shell("timeout -k 5 100 %s/hooke %s >said 2>&1", build, format:format(...))
  return how == "exit" and code or 128 + code, files.read(folder .. "/said")
end

files.write(folder .. "/scene.lua", [[
local scene = hooke.scene { duration = 0.2, fps = 20, integrator = "leapfrog", dt = 1e-3 }
local sheet = scene:grid { nx = 4, ny = 4, width = 1, height = 1, mass = 0.1 }
scene:channel("heat", { initial = 1, rate = function(_, _, y) return -y end })
scene:force("gravity", {})
scene:force("springs", { edges = sheet:structural(), k = 100 })
scene:output("trajectory", { precision = "double" })
return scene
]])
local code, said = hooke("run scene.lua --out good --quiet")
if said:find("without HDF5", 1, true) or said:find("no output 'trajectory'", 1, true) then
  print("skipped: hooke is built without HDF5")
  os.exit(77)
end
assert(code == 0, said)
assert(hooke("convert good --to csv --out good.csv") == 0)
assert(hooke("view good --page good.html") == 0)
local secret = "the-words-that-nobody-else-may-read-"
files.write(folder .. "/secret", secret:rep(8))

-- ---- what the file says ----

local tried, accepted = 0, {}
local make = ("cd %s && %s %s/tests/plugins/common/hdf5/foreign_recordings.py good/trajectory.h5 secret"):format(folder, python, root)
for name in assert(io.popen(make .. " list -")):lines() do
  assert(shell("rm -rf bad bad.csv bad.html && mkdir bad"))
  assert(os.execute(("%s %s bad/trajectory.h5"):format(make, name)), name)
  for _, words in ipairs { "convert bad --to csv --out bad.csv", "view bad --page bad.html" } do
    code, said = hooke(words)
    local _, lines = said:gsub("[^\n]+", "")
    if code ~= 4 or lines ~= 1 then accepted[#accepted + 1] = ("%s: %s: %s: %s"):format(name, words, code, said) end
  end
  assert(not shell("grep -q the-words- bad.csv bad.html 2>/dev/null"), name)
  assert(not shell("test -e bad.html || test -e bad.html.part"), name .. ": half a page is left")
  tried = tried + 1
end
assert(tried == 32 and #accepted == 0, table.concat(accepted, "\n"))

-- ---- what lies in the folder ----

local function intact() return files.read(folder .. "/victim") == "mine" end

files.write(folder .. "/victim", "mine")
assert(shell("mkdir bad/elsewhere; rm -rf bad && cp -r good bad && ln -s ../victim bad/page.html.part"))
code, said = hooke("view bad")
assert(code == 0 and intact() and shell("test -f bad/page.html && ! test -e bad/page.html.part"), said)
assert(shell("mkdir elsewhere && ln -s ../elsewhere bad/ply"))
code, said = hooke("convert bad --to ply")
assert(code ~= 0 and said:find("is a link", 1, true) and not shell("test -e elsewhere/000000.ply"), said)
assert(shell("rm bad/page.html && mkfifo bad/page.html && rm -f bad/summary.json && mkfifo bad/summary.json"))
code, said = hooke("view bad")
assert(code == 4 and said:find("is no plain file", 1, true), said)
code, said = hooke("view bad --page ours.html")
assert(code == 0 and shell("test -f ours.html"), said)
assert(shell("rm bad/trajectory.h5 && mkfifo bad/trajectory.h5"))
code, said = hooke("convert bad/trajectory.h5 --to csv")
assert(code == 4 and said:find("no whole HDF5 file", 1, true), said)

assert(shell("rm -rf %s", folder))
