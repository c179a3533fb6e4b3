-- libhooke: its functions are those of hooke.h and at most 30; its programs (tests/library) run and print nothing by themselves; two
-- runs at once give the bits that each gives by itself; one cloth in two processes has the bits of one.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD: the folder of the build")

local function output_of(command)
  local pipe = assert(io.popen(command .. " 2>&1"))
  local text = pipe:read("a")
  assert(pipe:close(), command .. "\n" .. text)
  return text
end

local function read(path)
  local file = assert(io.open(path))
  local text = file:read("a")
  file:close()
  return text
end

local declared, count = {}, 0
for name in read(root .. "/core/app/hooke/hooke.h"):gmatch("HOOKE_API [^;]-(hooke_[%w_]+)%(") do
  declared[name], count = true, count + 1
end
assert(count > 0 and count <= 30, ("hooke.h has %d functions, 30 are allowed"):format(count))
for name in output_of(("nm -D --defined-only '%s/libhooke.so'"):format(build)):gmatch(" T ([%w_]+)") do
  local own = declared[name] or name:find("^__%l+san_") or name == "_init" or name == "_fini"
  assert(own, name .. " is seen from outside, and not in hooke.h")
  declared[name] = nil
end
assert(not next(declared), ("%s is in hooke.h and not in the library"):format(next(declared)))

local scenes = root .. "/scripts/scenes"
local function run(program) return output_of(("cd '%s' && timeout 60 '%s/library/%s"):format(scenes, build, program)) end

local said = run("wrong_inputs'")
assert(said == "", said)
local kept = os.tmpname()
said = run(("changed' '%s'"):format(kept))
os.remove(kept)
assert(said == "", said)
said = run("pendulum'")
assert(said:find("; ok at 2 s", 1, true), said)
said = run(("two_processes' '%s/tests/fixtures/halo.so' 64 30"):format(build))
assert(said:find("the same bits", 1, true) and said:find("; 6144 bytes sent a step", 1, true), said)
said = run("threads' pendulum_chain.lua string.lua")
assert(said:find("the same bits", 1, true), said)
