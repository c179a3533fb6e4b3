-- The outputs that keep the motion, in whole runs: what they write is the state, bit by bit; h5py reads every dataset of a
-- recording; a run that is killed leaves its whole frames; births and deaths; what they say of wrong input.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = ("%s/tests/support/?.lua;%s"):format(root, package.path)
if not _G.hooke then os.exit(require("tool_tree").run(root, build, "tests/plugins/outputs/recordings.lua")) end
local files = require("files")
local recording = require("tool_tree").recording()

local folder = files.folder()

local function at(name) return folder .. "/" .. name end

local function shell(format, ...) return os.execute(format:format(...)) end

-- Runs hooke -> whether it ended well, what it printed.
local function hooke(format, ...)
  local fine = shell("cd %s && %s/hooke %s >log 2>&1", folder, build, format:format(...))
  return fine, files.read(at("log"))
end

local function must(format, ...)
  local fine, said = hooke(format, ...)
  assert(fine, said)
  return said
end

local function open(name) return assert(recording.open(at(name))) end

local scene = [[
local scene = hooke.scene { duration = 0.5, fps = 20, integrator = "leapfrog", dt = 1e-3 }
local sheet = scene:grid { nx = 5, ny = 4, width = 1, height = 1, mass = 0.1 }
scene:pin({ sheet:at(1, 1) }, { release = 0.21 })
scene:channel("heat", { initial = 1, rate = function(_, _, y) return -y end })
scene:channel("spin", { initial = { 1, 2, 3 } })
scene:force("gravity", {})
scene:force("springs", { edges = sheet:structural(), k = 100, damping = 0.01 })
scene:measure("sag, \"m\"", function(s) return s:position(20)[3] end)
local what = param("what", "trajectory")
local options = param("options", 0) == 1 and { only = { 1, 7, 8 }, every = 3, precision = "single" } or { forces = true }
if what == "all" then options = {} end
scene:output("trajectory", options)
if param("keep", 0) == 1 then scene:output("checkpoint", { every = 2 }) end
return scene
]]

local births = [[
local scene = hooke.scene { duration = 0.6, fps = 20, integrator = "leapfrog", dt = 1e-3 }
scene:force("gravity", {})
scene:source("emitter", { rate = 400, lifetime = 0.2, speed = 2, direction = { 0, 0, 1 }, mass = 1e-3 })
scene:output("trajectory", {})
return scene
]]

files.write(at("sheet.lua"), scene)
files.write(at("births.lua"), births)

-- Particle k (from 1) of a string of doubles, `width` each.
local function numbers(text, k, width)
  return { string.unpack("<" .. ("d"):rep(width), text, 8 * width * (k - 1) + 1) }
end

-- ---- the state, bit by bit ----

local function rows_of_state(name)
  local rows, text = {}, files.read(at(name))
  for line in text:gmatch("[^\n]+") do
    local row = {}
    for number in line:gmatch("[^,]+") do row[#row + 1] = tonumber(number) end
    if row[1] then rows[#rows + 1] = row end
  end
  return rows
end

local function is_state(r, k, rows)
  assert(r:n(k) == #rows, ("%d particles, %d in the state"):format(r:n(k), #rows))
  local x, v, m, ids = r:positions(k), r:velocities(k), r:masses(k), r:ids(k)
  for i, row in ipairs(rows) do
    assert(string.unpack("<I4", ids, 4 * i - 3) == row[1], "id")
    local p, u = numbers(x, i, 3), numbers(v, i, 3)
    for c = 1, 3 do assert(p[c] == row[1 + c] and u[c] == row[4 + c], "position or velocity") end
    assert(numbers(m, i, 1)[1] == row[8], "mass")
  end
end

must("run sheet.lua --out sheet --state state.csv --quiet")
local r = open("sheet/trajectory.h5")
assert(r.frames == 11 and r.fps == 20 and r.times[11] == 0.5 and r.attributes.verdict == "ok", r.attributes.verdict)
is_state(r, 11, rows_of_state("state.csv"))
assert(r.attributes.scene == "sheet.lua" and r.attributes.origin:find("the parameter what\ttrajectory", 1, true))
assert(#r.series["sag, \"m\""] == 11 and r.series["sag, \"m\""][11] == numbers(r:positions(11), 20, 3)[3])
assert(r.series.energy[11] == r.series.kinetic[11] + r.series.potential[11])
assert(r.series.step[1] == 0 and r.series.step[2] == 1e-3 and r.series.error[2] ~= r.series.error[2])
assert(#r.channels == 3 and r.channels[3].name == "tension N" and #r.forces == 2 and r.forces[2] == "springs")

-- The pin's release at 0.21 s is a change; nothing else is.
for k = 1, 11 do assert(r:topology_changed(k) == (k == 1 or k == 6), k) end
assert(r:pins(5):byte(1) == 1 and r:pins(6):byte(1) == 0)

-- Gravity is m g; the forces on a free particle are what accelerates it, the trapezoid of two steps of leapfrog.
assert(numbers(r:force("gravity", 3), 9, 3)[3] == numbers(r:masses(3), 9, 1)[1] * -9.81)
assert(#r:edges(1) == 8 * (4 * 4 + 5 * 3) and #r:triangles(1) == 12 * 2 * 4 * 3) -- structural edges, two triangles a square
local largest = 0
for e = 1, 31 do largest = math.max(largest, math.abs(numbers(r:edge_strain(11), e, 1)[1])) end
local most = 0
for i = 1, 20 do most = math.max(most, math.abs(numbers(r:strain(11), i, 1)[1])) end
assert(largest == most and largest > 0)
r:close()

-- ---- h5py ----

local python
for _, name in ipairs { "python3", "/usr/bin/python3" } do
  if not python and shell("%s -c 'import h5py, numpy' 2>/dev/null", name) then python = name end
end

-- Every array of every frame as the module gives it, to be compared with what h5py finds.
local function compare_with_h5py(name)
  if not python then return print("h5py is not installed: its part is left out") end
  local got = open(name)
  shell("rm -rf %s/dump && mkdir %s/dump", folder, folder)
  for k = 1, got.frames do
    local function dump(what, text) files.write(("%s/dump/%s.%d"):format(folder, what, k), text) end
    for _, what in ipairs { "positions", "velocities", "ids", "edges", "triangles" } do dump(what, got[what](got, k)) end
    for _, c in ipairs(got.channels) do dump("channel " .. c.name, got:channel(c.name, k)) end
    for _, f in ipairs(got.forces) do dump("force " .. f, got:force(f, k)) end
  end
  assert(shell("%s %s/tests/plugins/outputs/recordings.py %s %s/dump", python, root, at(name), folder), name)
end

compare_with_h5py("sheet/trajectory.h5")

-- ---- groups, and radii of strands ----

files.write(at("groups.lua"), [[
local scene = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog", dt = 1e-3 }
scene:strand { n = 3, length = 0.2, direction = { 1, 0, 0 }, radius = 0.002, E = 1e7, nu = 0.45, density = 1100, group = "rope" }
scene:particle { position = { 0, 0, 1 } }
scene:rigid { shape = "sphere", radius = 0.1, mass = 1, position = { 0, 1, 0 }, group = "a\nball" }
if param("all", 1) == 1 then scene:output("trajectory", {}) else scene:output("trajectory", { group = "rope" }) end
scene:force("gravity", {})
return scene
]])
must("run groups.lua --out groups --quiet")
r = open("groups/trajectory.h5")
assert(table.concat(r.groups, ", ") == "default, rope, a ball", table.concat(r.groups, ", ")) -- one a line: no line ends within
local function each(format, text) -- its first five numbers
  return table.concat({ string.unpack("<" .. format:rep(5), text) }, " ", 1, 5)
end
local groups, radii = r:groups_and_radii(2)
assert(each("I4", groups) == "1 1 1 0 2" and each("d", radii) == "0.002 0.002 0.002 0.0 0.0", each("d", radii))
assert(#r.solids == 1 and r.solids[1].body and r.solids[1].group == 3)
r:close()
compare_with_h5py("groups/trajectory.h5")
must("run groups.lua all=0 --out rope --quiet")
r = open("rope/trajectory.h5")
groups, radii = r:groups_and_radii(1)
assert(r:n(1) == 3 and groups == ("<I4I4I4"):pack(1, 1, 1) and radii == ("<ddd"):pack(0.002, 0.002, 0.002))
r:close()
r = open("sheet/trajectory.h5")
groups, radii = r:groups_and_radii(1)
assert(groups == nil and radii == nil and #r.groups == 0) -- one group, no strand
r:close()

-- ---- chosen particles and frames, in 32 bits ----

must("run sheet.lua options=1 --out part --quiet")
local part, whole = open("part/trajectory.h5"), open("sheet/trajectory.h5")
assert(part.frames == 4 and part.fps == 20 / 3 and part:n(4) == 3)
for j, i in ipairs { 1, 7, 8 } do
  local a, b = numbers(part:positions(4), j, 3), numbers(whole:positions(10), i, 3)
  for c = 1, 3 do assert(math.abs(a[c] - b[c]) <= 2 ^ -24 * math.abs(b[c])) end -- half a unit of a float's last place
end
assert(#part:edges(1) == 8) -- 7 and 8 are neighbours, 1 is neither's
compare_with_h5py("part/trajectory.h5")

-- ---- births and deaths ----

must("run births.lua --out births --state state.csv --quiet")
local b = open("births/trajectory.h5")
is_state(b, b.frames, rows_of_state("state.csv"))
must("convert births --to csv")
local seen, row = 0, 0
local table_rows = rows_of_state("births/converted.csv") -- t, id, x, y, z, ...
for k = 1, b.frames do
  for i = 1, b:n(k) do
    row = row + 1
    local of = table_rows[row]
    assert(of[1] == b.times[k] and of[2] == string.unpack("<I4", b:ids(k), 4 * i - 3))
    assert(of[3] == numbers(b:positions(k), i, 3)[1] and of[5] == numbers(b:positions(k), i, 3)[3])
  end
  seen = math.max(seen, b:n(k))
end
assert(row == #table_rows and b:n(1) < 5 and seen >= 75 and seen <= 85, seen) -- 400 1/s for 0.2 s
compare_with_h5py("births/trajectory.h5")

-- ---- conversions to other formats ----

must("run sheet.lua what=all --out all --quiet")
for _, format in ipairs { "ply", "obj", "vtk", "csv", "pc2" } do must("convert all --to %s", format) end
must("convert all --to vtkhdf --out again.h5")
local again, first = open("again.h5"), open("all/trajectory.h5")
for k = 1, first.frames do
  assert(again:positions(k) == first:positions(k) and again:edges(k) == first:edges(k))
  assert(again:topology_changed(k) == first:topology_changed(k) and again.series.kinetic[k] == first.series.kinetic[k])
end
compare_with_h5py("again.h5")

-- PLY: doubles, little endian, behind a head of lines.
local ply = files.read(at("all/ply/000010.ply"))
local head = ply:match("^(.-end_header\n)")
assert(head:find("format binary_little_endian 1.0", 1, true) and head:find("element vertex 20\n", 1, true)
  and head:find("property double x\nproperty double y\nproperty double z\n", 1, true) and head:find("element face 24\n", 1, true), head)
assert(ply:sub(#head + 1, #head + 24) == first:positions(11):sub(1, 24))

-- VTK: doubles, big endian; one frame more would be too many.
local vtk = files.read(at("all/vtk/000010.vtk"))
local points = select(2, assert(vtk:find("POINTS 20 double\n", 1, true)))
for k = 1, 60 do
  assert(string.unpack(">d", vtk, points + 8 * k - 7) == string.unpack("<d", first:positions(11), 8 * k - 7), k)
end
assert(files.read(at("all/obj/000010.obj")) and not files.read(at("all/vtk/000011.vtk")))

-- CSV: a row for each particle at each frame, in digits that restore every double.
local rows = rows_of_state("all/converted.csv")
assert(#rows == 11 * 20 and rows[220][1] == 0.5 and rows[220][2] == 20)
for i = 1, 20 do
  local p, v = numbers(first:positions(11), i, 3), numbers(first:velocities(11), i, 3)
  for c = 1, 3 do assert(rows[200 + i][2 + c] == p[c] and rows[200 + i][5 + c] == v[c], i) end
end

-- PC2: a head of 32 bytes, 3 floats per particle and frame, little endian.
local cache = files.read(at("all/converted.pc2"))
local magic, version, n, start, rate, samples, begin = string.unpack("<c12i4i4ffi4", cache)
assert(magic == "POINTCACHE2\0" and version == 1 and n == 20 and start == 0 and rate == 1 and samples == 11 and begin == 33)
assert(#cache == 32 + 11 * 20 * 12)
local x = numbers(first:positions(11), 20, 3)[3]
assert(string.unpack("<f", cache, 33 + 12 * (20 * 10 + 19) + 8) == string.unpack("<f", string.pack("<f", x)))

-- OBJ: the mesh of the cache.
local vertices, faces, lines = 0, 0, 0
for line in files.read(at("all/converted.obj")):gmatch("[^\n]+") do
  if line:find("^v ") then vertices = vertices + 1 elseif line:find("^f ") then faces = faces + 1
  elseif line:find("^l ") then lines = lines + 1 end
end
assert(vertices == 20 and faces == 24 and lines == 31)

-- ---- a run that is killed ----

local function same_frames(part_of, all)
  for k = 1, part_of.frames do
    assert(part_of:positions(k) == all:positions(k) and part_of:force("springs", k) == all:force("springs", k), k)
  end
end

files.write(at("long.lua"), (scene:gsub("duration = 0.5, fps = 20", "duration = 5, fps = 400")))
must("run long.lua --out long --quiet")
local long, counts = open("long/trajectory.h5"), {}
math.randomseed(7)
for k = 1, 8 do
  shell("cd %s && { %s/hooke run long.lua --out killed --quiet & pid=$!; sleep %.3f; kill -9 $pid; wait $pid; } 2>/dev/null >&2",
    folder, build, 0.05 + 0.1 * math.random())
  local killed = recording.open(at("killed/trajectory.h5"))
  counts[k] = killed and killed.frames or 0
  if killed then same_frames(killed, long) end
end
print("frames that killed runs left: " .. table.concat(counts, " "))

-- ---- a run that goes on ----

must("run sheet.lua keep=1 --until 0.3 --out on --quiet")
must("run sheet.lua --resume on/newest.checkpoint --until 0.5 --out on --quiet")
local parts = io.popen(("ls %s/on/from-step-*/trajectory.h5"):format(folder)):read("l")
local later = assert(recording.open(parts))
assert(open("on/trajectory.h5").times[7] == 0.3 and later.times[1] > 0.3 - 1e-9)
is_state(later, later.frames, (must("run sheet.lua --out sheet --state state.csv --quiet") and rows_of_state("state.csv")))

-- ---- wrong input ----

local function refused(text, format, ...)
  local fine, said = hooke(format, ...)
  assert(not fine and said:find(text, 1, true), said)
end

files.write(at("group.lua"), scene:gsub("forces = true", "group = 'nobody'"))
refused("group: no particle is in a group 'nobody'", "run group.lua --out x --quiet")
files.write(at("full.lua"), scene:gsub("forces = true", "file = '../x'"))
refused("is not a file name inside the output folder", "run full.lua --out x --quiet")
files.write(at("felt.lua"), [[
local scene = hooke.scene { duration = 0.1, fps = 20, dt = 1e-3 }
scene:particle { position = { 0, 0, 1 }, mass = 1 }
scene:force("wind", { label = "breeze", on = "particles", d = 0.1 })
scene:corrector("obstacle", { shape = "sphere", radius = 0.1, position = { 0, 0, 0 } })
scene:output("trajectory")
return scene
]])
must("run felt.lua --out felt --quiet")
assert(must("convert felt --to vtk"):find("left out: obstacles (sphere); the wind of 'breeze'; points of contact", 1, true))
assert(not must("convert all --to ply"):find("left out", 1, true))
refused("has no trajectory.h5", "convert %s --to ply", folder)
refused("no whole HDF5 file", "convert damaged.h5 --to ply", files.write(at("damaged.h5"),
  files.read(at("sheet/trajectory.h5")):sub(1, 20000)))
refused("no whole HDF5 file", "convert sheet.lua --to ply")
-- A limit of the size of files, 512 or 1024 bytes, is as a full disk: it is said by its name, and no half of a file stays.
for _, format in ipairs { "csv", "pc2", "vtkhdf", "xdmf", "ply", "vtk", "gltf" } do
  assert(shell("cd %s && rm -rf full && mkdir full", folder))
  local fine = shell("cd %s && (ulimit -f 1; %s/hooke convert sheet --to %s --out full/x >log 2>&1)", folder, build, format)
  assert(not fine and files.read(at("log")):find("cannot write full/x[^:]*: File too large\n"), files.read(at("log")))
  assert(shell("test -z \"$(find %s/full -type f)\"", folder), format)
end
assert(must("convert sheet --to csv --out \"$(printf 'x\\033[2Jy')\""):find("11 frames: x\\x1b[2Jy.csv", 1, true)) -- tools print so
refused("--from-frame 12: sheet/trajectory.h5 has the frames 1 to 11", "convert sheet --to csv --from-frame 12")
refused("--from-frame 5 is after --to-frame 2", "convert sheet --to csv --from-frame 5 --to-frame 2")
refused("--ids: no particle of these frames has the id 99999", "convert sheet --to csv --ids 1,99999 --out none")
assert(not files.read(at("none.csv")))
refused("particles were born or died", "convert births --to pc2")
assert(must("run births.lua --out births --quiet"))

assert(shell("rm -rf %s", files.quoted(folder)))
