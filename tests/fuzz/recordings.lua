-- Damaged recordings of the output trajectory, in `hooke convert` and `hooke view`; see tests/support/fuzz/run.lua. HDF5
-- 1.10 leaks and crashes by itself in some damaged files: leaks are not looked for, and what falls within it is its own.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local bytes = require("fuzz.bytes")

if not io.open(assert(os.getenv("HK_BUILD")) .. "/plugins/outputs/trajectory.so") then
  print("skipped: built without HDF5")
  os.exit(77)
end

local scenes = {
  [[local g = s:grid { nx = 3, ny = 3 } s:force("springs", { edges = g:edges(), k = 100, damping = 1 })
s:force("membrane", { triangles = g:triangles(), stiffness = 10 }) s:channel("heat", { initial = 1, rate = -2 })]],
  [[local h = s:strand { n = 4, from = { 0, 0, 0 }, to = { 1, 0, 0 }, radius = 0.01, E = 1e7, nu = 0.4, density = 1000, group = "rope" }
s:pin { 1 } s:force("springs", { edges = h:edges(), k = 9 }) s:rigid { shape = "sphere", radius = 0.1, mass = 1, group = "ball" }
s:measure("x", function(state) return state:position(2)[1] end)
s:corrector("obstacle", { shape = "sphere", radius = 1, position = { 0, 0, -2 } })]],
  [[s:source("emitter", { rate = 300, speed = 1, lifetime = 0.02 })]],
}

local scene = [[
local s = hooke.scene { duration = 0.1, fps = 50, integrator = "leapfrog" }
s:force("gravity", {})
%s
s:output("trajectory", { forces = true })
return s
]]

local whole = {}

-- Writes a recording of each scene.
local function record(place)
  for k, what in ipairs(scenes) do
    local file = assert(io.open(place .. "/record.lua", "w"))
    file:write(scene:format(what))
    file:close()
    assert(os.execute(("cd %s && { %s %s run record.lua --quiet --out kept%d; [ $? = 0 ] || [ $? = 5 ]; } 2>/dev/null"):format(place,
      run.before, run.hooke, k)))
    local saved = assert(io.open(("%s/kept%d/trajectory.h5"):format(place, k), "rb"))
    whole[k] = saved:read("a")
    saved:close()
  end
end

local numbers = { 0, 1, 2, 7, -1, 0x7fffffff, 0xffffffff, 1 << 32, math.maxinteger, math.mininteger, 1 << 40 }

-- Mostly in place, so that the structure stays: bits, bytes and numbers of 1, 2, 4 and 8 bytes.
local function damaged(text)
  if math.random(6) == 1 then return bytes.binary(text) end
  for _ = 1, math.random(6) do
    local size = 1 << math.random(0, 3)
    local at = math.random(1, #text - size + 1)
    local by = string.pack("<i8", numbers[math.random(#numbers)]):sub(1, size)
    if math.random(2) == 1 then by, size = string.char(text:byte(at) ~ (1 << math.random(0, 7))), 1 end
    text = text:sub(1, at - 1) .. by .. text:sub(at + size)
  end
  return text
end

local words = { "convert trajectory.h5 --to csv --out out.csv", "convert trajectory.h5 --to ply --out out",
  "convert trajectory.h5 --to vtkhdf --out out.h5", "convert trajectory.h5 --to pc2 --out out", "convert . --to obj --out out",
  "convert trajectory.h5 --to gltf --out out.glb",
  "view . --page page.html --quiet" }

run.fuzz {
  name = "recordings",
  cases = 30,
  prepare = record,
  make = function()
    return { files = { ["trajectory.h5"] = damaged(whole[math.random(#whole)]) }, words = words[math.random(#words)],
      library = "libhdf5", before = [[sh -c 'ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 exec "$@"' it]] }
  end,
}
