-- What particles bounce off, in recordings: kinds and meshes, and where each is at every frame, as the script says it; h5py
-- finds the same by what solid_series.h says of the layout; without obstacles there is no group.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
if not _G.hooke then os.exit(require("tool_tree").run(root, build, "tests/plugins/common/frame_data/solids.lua")) end
local files = require("files")
local recording = require("tool_tree").recording()

local folder = files.folder()

files.write(folder .. "/all.lua", [[
local scene = hooke.scene { duration = 0.5, fps = 20, integrator = "leapfrog", dt = 1e-3 }
scene:particle { position = { 0, 0, 5 } }
scene:force("gravity", {})
if param("some", 1) == 1 then
  scene:corrector("obstacle", { label = "floor", normal = { 0, 3, 4 }, position = { 0, 0, -1 } })
  scene:corrector("obstacle", { label = "ball", shape = "sphere", size = { 2, 2, 2 },
    position = function(t) return { t, -2 * t, 0.5 } end })
  scene:corrector("obstacle", { label = "lid", shape = "box", size = { 1, 2, 3 }, position = { 9, 0, 0 },
    rotation = function(t) return { 0, 0, math.pi * t } end })
  scene:corrector("obstacle", { label = "pipe", shape = "cylinder", size = { 20, 20, 30 }, hollow = true })
  scene:corrector("obstacle", { label = "pill", shape = "capsule", size = { 1, 1, 4 }, position = { -9, 0, 0 } })
  scene:corrector("obstacle", { label = "wedge", shape = "mesh", position = { 0, 0, -3 },
    vertices = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 }, faces = { 1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4 } })
end
scene:output("trajectory", {})
return scene
]])

local function run(words, name)
  local log = folder .. "/log"
  assert(os.execute(("cd %s && %s/hooke run all.lua %s --out %s --quiet >log 2>&1"):format(folder, build, words, name)),
    files.read(log))
  return assert(recording.open(("%s/%s/trajectory.h5"):format(folder, name)))
end

local none = run("some=0", "none")
assert(#none.solids == 0 and none:solid_places(1) == "")
none:close()

local r = run("", "all")
local kinds = {}
for k, s in ipairs(r.solids) do
  kinds[k] = s.kind
  assert(s.hollow == (s.kind == "cylinder") and #s.vertices == (s.kind == "mesh" and 4 * 24 or 0))
end
assert(table.concat(kinds, " ") == "plane sphere box cylinder capsule mesh", table.concat(kinds, " "))
assert(r.solids[6].faces == string.pack("<" .. ("I4"):rep(12), 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3))
assert(string.unpack("<d", r.solids[6].vertices, 8 * 11 + 1) == 1)

-- Numbers of the places of solid k: the script's functions, whose rounding differs by that of a product at most.
local function is(frame, k, from, wanted)
  local got = { string.unpack("<" .. ("d"):rep(12), r:solid_places(frame), 96 * (k - 1) + 1) }
  for c, value in ipairs(wanted) do
    assert(math.abs(got[from + c - 1] - value) <= 1e-14, ("frame %d, solid %d, number %d: %.17g, expected %.17g"):format(frame,
      k, from + c - 1, got[from + c - 1], value))
  end
end

for frame = 1, r.frames do
  local t = r.times[frame]
  is(frame, 1, 1, { 0, 0, -1 })
  is(frame, 1, 10, { 0, 0.6, 0.8 })
  is(frame, 2, 1, { t, -2 * t, 0.5, 1, 0, 0, 0, 1, 0, 0, 0, 1 })
  local c, s = math.cos(math.pi * t), math.sin(math.pi * t)
  is(frame, 3, 1, { 9, 0, 0, c / 2, s / 2, 0, -s, c, 0, 0, 0, 1.5 })
  is(frame, 5, 1, { -9, 0, 0, 0.5, 0, 0, 0, 0.5, 0, 0, 0, 2 })
  is(frame, 6, 1, { 0, 0, -3, 1, 0, 0, 0, 1, 0, 0, 0, 1 })
end

-- ---- h5py ----

files.write(folder .. "/read.py", [[
import sys, h5py, numpy as np
file = h5py.File(sys.argv[1], "r")
group, frames = file["hooke/solids"], int(file["VTKHDF/Steps"].attrs["NSteps"])
assert list(group["kind"]) == [0, 1, 2, 3, 4, 5] and list(group["hollow"]) == [0, 0, 0, 1, 0, 0]
assert group["mesh"][5].tolist() == [4, 4] and group["vertex"].shape == (4, 3) and group["face"].shape == (4, 3)
assert np.array_equal(group["place"][:frames], np.fromfile(sys.argv[2]).reshape(frames, 72))
assert "solids" not in h5py.File(sys.argv[3], "r")["hooke"]
]])
local places = {}
for k = 1, r.frames do places[k] = r:solid_places(k) end
files.write(folder .. "/places", table.concat(places))
r:close()
local python
for _, name in ipairs { "python3", "/usr/bin/python3" } do
  if not python and os.execute(("%s -c 'import h5py, numpy' 2>/dev/null"):format(name)) then python = name end
end
if python then
  assert(os.execute(("cd %s && %s read.py all/trajectory.h5 places none/trajectory.h5"):format(folder, python)))
else
  print("h5py is not installed: its part is left out")
end
os.execute("rm -rf " .. files.quoted(folder))
