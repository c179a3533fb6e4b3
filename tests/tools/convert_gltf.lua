-- hooke convert --to gltf: the file's heads and lengths, and that its meshes, targets and animations give back the motion.
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local files = require("files")
local fine, cjson = pcall(require, "cjson")
if not fine then
  print("skipped: lua-cjson is not installed (tools/install-deps test)")
  os.exit(77)
end

local folder = files.folder()

local function hooke(words)
  local pipe = io.popen(("cd %s && %s/hooke %s 2>&1"):format(folder, build, words))
  local text = pipe:read("a")
  local ended = pipe:close()
  if text:find("built without HDF5", 1, true) then
    print("skipped: hooke is built without HDF5")
    os.exit(77)
  end
  return ended, text
end

local function must(words)
  local ended, said = hooke(words)
  assert(ended, said)
end

-- The JSON and the binary part of a file.
local function read_glb(name)
  local text = assert(files.read(folder .. "/" .. name))
  local magic, version, length, json, kind = string.unpack("<c4I4I4I4c4", text)
  assert(magic == "glTF" and version == 2 and length == #text and kind == "JSON" and json % 4 == 0, "the head")
  local bytes, binary = string.unpack("<I4c4", text, 21 + json)
  assert(binary == "BIN\0" and 28 + json + bytes == #text, "the binary part")
  return cjson.decode(text:sub(21, 20 + json)), text:sub(29 + json)
end

local widths = { SCALAR = 1, VEC3 = 3 }

-- The numbers of accessor k (from 0); of a sparse one those that are not 0, as { index, value }.
local function numbers(glb, binary, k)
  local a = glb.accessors[k + 1]
  local function list(view, format, count)
    local v, got = glb.bufferViews[view + 1], {}
    assert(v.byteLength == 4 * count, "a view has the length of its numbers")
    for i = 1, count do got[i] = string.unpack(format, binary, v.byteOffset + 4 * i - 3) end
    return got
  end
  if a.sparse then
    return list(a.sparse.indices.bufferView, "<I4", a.sparse.count), list(a.sparse.values.bufferView, "<f", a.sparse.count)
  end
  local got = list(a.bufferView, a.componentType == 5126 and "<f" or "<I4", widths[a.type] * a.count)
  for c = 1, a.min and widths[a.type] or 0 do
    local low, high = math.huge, -math.huge
    for i = c, #got, widths[a.type] do low, high = math.min(low, got[i]), math.max(high, got[i]) end
    assert(math.abs(low - a.min[c]) <= 1e-8 * math.abs(low) and math.abs(high - a.max[c]) <= 1e-8 * math.abs(high), "bounds")
  end
  return got
end

-- ---- cloth, a strand and a lone particle: one mesh ----

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
must("run sheet.lua --quiet --out sheet")
must("convert sheet --to gltf")
must("convert sheet --to csv")
local rows = {}
for line in io.lines(folder .. "/sheet/converted.csv") do
  local t, id, x, y, z = line:match("^([^,]+),(%d+),([^,]+),([^,]+),([^,]+)")
  if tonumber(t) then rows[#rows + 1] = { t = t + 0, id = id + 0, t and x + 0, y + 0, z + 0 } end
end
assert(#rows == 5 * 16, #rows)

local glb, binary = read_glb("sheet/converted.glb")
assert(glb.asset.version == "2.0" and #glb.meshes == 1 and #glb.nodes == 2 and glb.buffers[1].byteLength == #binary)
local modes, triangles = {}, nil
for _, part in ipairs(glb.meshes[1].primitives) do
  modes[#modes + 1] = math.tointeger(part.mode)
  assert(#part.targets == 4)
  if part.mode == 4 then triangles = part end
end
assert(table.concat(modes, " ") == "4 1 0", "triangles, segments, points: " .. table.concat(modes, " "))
assert(#numbers(glb, binary, triangles.indices) == 3 * 12)
local origin, base = glb.nodes[1].translation, numbers(glb, binary, triangles.attributes.POSITION)
local function check(frame, position)
  for i = 1, 16 do
    local row = rows[16 * frame + i]
    local x, y, z = position(3 * i - 2), position(3 * i - 1), position(3 * i)
    -- y is up: (x, y, z) of the scene are (x, z, -y) of the file, whose node turns them.
    local off = math.max(math.abs(row[1] - x - origin[1]), math.abs(row[2] - y + origin[3]), math.abs(row[3] - z - origin[2]))
    assert(off < 1e-5, ("frame %d, particle %d: off by %g m"):format(frame, i, off)) -- 24 bits of 50 m: 3e-6, and a sum
  end
end
check(0, function(k) return base[k] end)
for frame = 1, 4 do
  local target = numbers(glb, binary, triangles.targets[frame].POSITION)
  check(frame, function(k) return base[k] + target[k] end)
end
for i, n in ipairs { base, numbers(glb, binary, triangles.attributes.NORMAL) } do
  for k = 1, i == 2 and #n or 0, 3 do assert(math.abs(n[k] ^ 2 + n[k + 1] ^ 2 + n[k + 2] ^ 2 - 1) < 1e-6, "of length one") end
end
local animation = glb.animations[1]
assert(#animation.channels == 1 and animation.channels[1].target.path == "weights" and animation.channels[1].target.node == 1)
local times = numbers(glb, binary, animation.samplers[1].input)
for k = 1, 5 do assert(math.abs(times[k] - 0.1 * (k - 1)) < 1e-7) end
local places, ones = numbers(glb, binary, animation.samplers[1].output)
for k = 1, 4 do assert(places[k] == 4 * k + k - 1 and ones[k] == 1) end -- frame k has target k alone
must("convert sheet --to gltf --up y --out up")
local up = read_glb("up.glb")
assert(not up.nodes[1].rotation and math.abs(up.nodes[1].translation[2] - (5 + 0) / 2) < 1, "as it is")

-- ---- what has an edge is drawn with it ----

files.write(folder .. "/box.lua", [[
local scene = hooke.scene { duration = 0.1, fps = 10, integrator = "leapfrog", dt = 1e-2 }
local v = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }
scene:mesh { vertices = v, faces = { { 1, 3, 2 }, { 1, 2, 4 }, { 2, 3, 4 }, { 1, 4, 3 } }, mass = 1 }
scene:output("trajectory", {})
return scene
]])
must("run box.lua --quiet --trust --out box")
must("convert box --to gltf")
assert(not read_glb("box/converted.glb").meshes[1].primitives[1].attributes.NORMAL)

-- ---- particles that are born: a mesh each time, which a node shows while it holds ----

files.write(folder .. "/born.lua", [[
local scene = hooke.scene { duration = 0.5, fps = 10, integrator = "leapfrog", dt = 0.01 }
scene:source("emitter", { rate = 5, position = { 0, 0, 0 }, direction = { 0, 0, 1 }, speed = 2, mass = 0.01 })
scene:output("trajectory", {})
return scene
]])
must("run born.lua --quiet --out born")
must("convert born --to gltf")
glb, binary = read_glb("born/converted.glb")
assert(#glb.meshes > 1 and #glb.nodes == 1 + #glb.meshes)
local shown = {} -- at the time of each frame
for _, channel in ipairs(glb.animations[1].channels) do
  if channel.target.path == "scale" then
    local sampler = glb.animations[1].samplers[channel.sampler + 1]
    local t, size = numbers(glb, binary, sampler.input), numbers(glb, binary, sampler.output)
    assert(sampler.interpolation == "STEP" and 3 * #t == #size)
    for frame = 0, 5 do
      local now = 0
      for k = 1, #t do
        assert(k == 1 or t[k] > t[k - 1], "times rise")
        if t[k] <= 0.1 * frame + 1e-6 then now = size[3 * k] end
      end
      shown[frame] = (shown[frame] or 0) + now
    end
  end
end
local first = 0
while shown[first] == 0 do first = first + 1 end -- nothing is born yet
for frame = first, 5 do assert(shown[frame] == 1, ("frame %d shows %g meshes"):format(frame, shown[frame])) end

-- ---- wrong words ----

local ended, said = hooke("convert sheet --to gltf --ids 1")
assert(not ended and said:find("--ids is for --to csv", 1, true), said)
ended, said = hooke("convert sheet --to obj --up y")
assert(not ended and said:find("--up is for --to gltf or usd", 1, true), said)
os.execute("rm -r " .. files.quoted(folder))
print("passed")
