-- hooke convert --to usd: its samples give back the motion, cells come again where particles are born, and OpenUSD itself, where
-- python3 has it (pip install usd-core), finds the topology right and the same numbers.
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local files = require("files")

local folder = files.folder()

local function hooke(words)
  local pipe = io.popen(("cd %s && %s/hooke %s 2>&1"):format(folder, build, words))
  local text = pipe:read("a")
  local ended = pipe:close()
  if text:find("built without HDF5", 1, true) then
    print("skipped: hooke is built without HDF5")
    os.exit(77)
  end
  assert(ended, text)
end

-- The samples of an attribute of a prim: { { t, "text" }, ... }; nil: there are none.
local function samples(text, prim, attribute)
  local body = text:match('def %w+ "' .. prim .. '"\n    {(.-)\n    }')
  local list = body and body:match("%] " .. attribute .. "%.timeSamples = {\n(.-)        }")
  if not list then return nil end
  local got = {}
  for t, values in list:gmatch("([%d.]+): %[(.-)%],\n") do got[#got + 1] = { tonumber(t), values } end
  return got
end

local function numbers(text)
  local got = {}
  for word in text:gmatch("[-%d.e+]+") do got[#got + 1] = assert(tonumber(word), word) end
  return got
end

files.write(folder .. "/sheet.lua", [[
local scene = hooke.scene { duration = 0.4, fps = 10, integrator = "leapfrog", dt = 1e-3 }
local cloth = scene:grid { nx = 4, ny = 3, width = 1, height = 1, mass = 0.1 }
scene:pin { 1, 4 }
local strand = scene:strand { n = 3, length = 1, mass = 0.1, from = { 3, 0, 0 } }
scene:particle { position = { 100, 5, 7 }, velocity = { 1, 2, 3 }, mass = 1 }
scene:force("gravity", {})
scene:force("springs", { edges = cloth:structural() .. strand:edges(), k = 50 })
scene:output("trajectory", {})
return scene
]])
hooke("run sheet.lua --quiet --out sheet")
hooke("convert sheet --to usd")
hooke("convert sheet --to csv")
local text = assert(files.read(folder .. "/sheet/converted.usda"))
local origin = numbers(text:match("xformOp:translate = (%b())"))
assert(#origin == 3 and text:find('upAxis = "Z"', 1, true) and text:find("timeCodesPerSecond = 10\n", 1, true), text:sub(1, 400))
assert(text:find("startTimeCode = 0\n", 1, true) and text:find("endTimeCode = 4\n", 1, true))

-- Particles 1 to 12 are the mesh's, 13 to 15 the strand's, 16 stands alone. The springs of the cloth are edges of its triangles.
local kinds = { { "surface", 1, 12 }, { "strands", 13, 15 }, { "particles", 16, 16 } }
local place, speed = {}, {}
for _, kind in ipairs(kinds) do
  place[kind[1]], speed[kind[1]] = samples(text, kind[1], "points"), samples(text, kind[1], "velocities")
  assert(#place[kind[1]] == 5 and #speed[kind[1]] == 5, kind[1])
end
local compared = 0
for line in io.lines(folder .. "/sheet/converted.csv") do
  local row = numbers(line)
  local id, frame = row[2], row[1] and math.floor(10 * row[1] + 1.5)
  for _, kind in ipairs(line:match("^[%d.]") and kinds or {}) do
    if id >= kind[2] and id <= kind[3] then
      local x, v = numbers(place[kind[1]][frame][2]), numbers(speed[kind[1]][frame][2])
      assert(#x == 3 * (kind[3] - kind[2] + 1) and #v == #x)
      for c = 1, 3 do
        local k = 3 * (id - kind[2]) + c
        assert(math.abs(x[k] + origin[c] - row[2 + c]) < 4e-6, line) -- 24 bits of 50 m: 3e-6
        assert(math.abs(v[k] - row[5 + c]) <= 1.2e-7 * math.abs(row[5 + c]) + 1e-12, line)
        compared = compared + 1
      end
    end
  end
end
assert(compared == 3 * 16 * 5, compared)
local corners = samples(text, "surface", "faceVertexIndices")
assert(#corners == 1 and #numbers(corners[1][2]) == 36 and #numbers(samples(text, "surface", "faceVertexCounts")[1][2]) == 12)
assert(samples(text, "strands", "curveVertexCounts")[1][2] == "3" and samples(text, "particles", "ids")[1][2] == "16")
hooke("convert sheet --to usd --up y --out up")
assert(files.read(folder .. "/up.usda"):find('upAxis = "Y"', 1, true))

-- ---- particles that are born: none before, then more and more ----

files.write(folder .. "/born.lua", [[
local scene = hooke.scene { duration = 0.5, fps = 10, integrator = "leapfrog", dt = 0.01 }
scene:source("emitter", { rate = 5, position = { 0, 0, 0 }, direction = { 0, 0, 1 }, speed = 2, mass = 0.01 })
scene:output("trajectory", {})
return scene
]])
hooke("run born.lua --quiet --out born")
hooke("convert born --to usd")
text = assert(files.read(folder .. "/born/converted.usda"))
local ids, points = samples(text, "particles", "ids"), samples(text, "particles", "points")
assert(ids[1][1] == 0 and ids[1][2] == "" and points[1][2] == "", "nothing is born yet")
for _, sample in ipairs(points) do
  local now
  for _, list in ipairs(ids) do if list[1] <= sample[1] then now = #numbers(list[2]) end end
  assert(#numbers(sample[2]) == 3 * now, "as many points as ids")
end
assert(#numbers(ids[#ids][2]) > 1)
local leftover = io.popen("ls " .. files.quoted(folder .. "/born")):read("a")
assert(not leftover:find("part", 1, true), leftover)

-- ---- OpenUSD reads it ----

files.write(folder .. "/read.py", [[
import sys
from pxr import Usd, UsdGeom
stage = Usd.Stage.Open("sheet/converted.usda")
mesh = UsdGeom.Mesh.Get(stage, "/hooke/surface")
counts, corners = mesh.GetFaceVertexCountsAttr().Get(2.0), mesh.GetFaceVertexIndicesAttr().Get(2.0)
fine, why = UsdGeom.Mesh.ValidateTopology(corners, counts, len(mesh.GetPointsAttr().Get(2.0)))
assert(fine), why
assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 1
lone = UsdGeom.Points.Get(stage, "/hooke/particles")
x = UsdGeom.XformCache(2.0).GetLocalToWorldTransform(lone.GetPrim()).Transform(lone.GetPointsAttr().Get(2.0)[0])
assert abs(x[0] - 100.2) < 1e-5 and abs(x[1] - 5.4) < 1e-5, x
curves = UsdGeom.BasisCurves.Get(stage, "/hooke/strands")
assert curves.GetTypeAttr().Get() == "linear" and list(curves.GetCurveVertexCountsAttr().Get(0.0)) == [3]
]])
if os.execute("python3 -c 'import pxr' 2>/dev/null") then
  assert(os.execute("cd " .. files.quoted(folder) .. " && python3 read.py"))
  print("OpenUSD reads it")
end
os.execute("rm -r " .. files.quoted(folder))
print("passed")
