-- Results of sweeps. Processes that make the same database at the same time wait for each other.
-- The keys of cases: digests tell texts apart, and where two cases have the same key all the same (forged here, for it
-- does not happen by itself), neither finding nor merging takes one for the other.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
package.path = ("%s/tools/?.lua;%s/scripts/lib/?.lua;%s"):format(root, root, package.path)
for _, name in ipairs { "luasql.sqlite3", "lfs" } do
  if not pcall(require, name) then
    print("skipped: Lua's " .. name .. " is not installed")
    os.exit(77)
  end
end
local digest = require("common.sweep.digest")
local store = require("common.sweep.store")

-- ---- digests ----

-- Of n random 128-bit numbers two agree in some 64 bits with probability n^2 / 2^65: 1e-9 for 2e5. Every half is tried.
local seen = { {}, {} }
local function new(text)
  local d = digest.of(text)
  assert(#d == 32 and d:match("^%x+$"), d)
  for half = 1, 2 do
    local part = d:sub(16 * half - 15, 16 * half)
    assert(not seen[half][part], ("two texts with %s; one of %d bytes"):format(part, #text))
    seen[half][part] = true
  end
end

for length = 0, 200 do new(("\0"):rep(length)) end -- nothing but their length
for length = 1, 200 do new(("\0"):rep(length - 1) .. "\1") end
local base = ("The same text of some length, again and again. "):rep(20)
for at = 1, #base do -- one bit
  for bit = 0, 7 do new(base:sub(1, at - 1) .. string.char(base:byte(at) ~ (1 << bit)) .. base:sub(at + 1)) end
end
for k = 1, 100000 do new(("param k = %d\nintegrator = rk4"):format(k)) end
for at = 17, 700, 16 do -- blocks exchanged
  local swapped = base:sub(1, at - 17) .. base:sub(at, at + 15) .. base:sub(at - 16, at - 1) .. base:sub(at + 16)
  if swapped ~= base then new(swapped) end
end

-- ---- forged keys ----

local folder = os.tmpname()
os.remove(folder)
local function open(name) return store.open(("%s/%s.db"):format(folder, name)) end

local function case(key, settings)
  return { key = key, grounds = "scene s", settings = settings, number = 1, ["repeat"] = 1, params = {},
    values = { scene = "s" } }
end

local function put(results, c)
  results:begin("s", "k = 1")
  results:add(c, { verdict = "ok", measures = { y = 0.1 } })
end

local function refuses(what, act)
  local fine, why = pcall(act)
  assert(not fine and tostring(why):find("two different cases have the key", 1, true), what .. ": " .. tostring(why))
end

local one, other = open("one"), open("other")
put(one, case("aaaa", "k = 1"))
put(other, case("aaaa", "k = 2"))
refuses("finding", function() one:find { case("aaaa", "k = 2") } end)
assert(one:find { case("aaaa", "k = 1") } == 1)
refuses("merging", function() one:merge(folder .. "/other.db") end)

-- A merge that failed changed nothing, and one that is right brings the measures along, bit by bit.
local third = open("third")
put(third, case("bbbb", "k = 3"))
assert(one:merge(folder .. "/third.db") == 1)
assert(one:merge(folder .. "/third.db") == 0)
local back = { case("aaaa", "k = 1"), case("bbbb", "k = 3") }
assert(one:find(back) == 2)
one:read(back)
assert(back[1].result.description == "scene s\nk = 1" and back[2].result.measures.y == 0.1)

for _, results in ipairs { one, other, third } do results:close() end

-- ---- processes that start together ----

-- SQLite refuses one of two processes that change the journal of a new file in the same moment: of 400 rounds of three, 26
-- had a process that failed where it did not try again, so that 100 rounds find that with probability 0.998.
local program = folder .. "/open.lua"
local file = assert(io.open(program, "w"))
file:write(("package.path = %q\n"):format(package.path), [[
local store = require("common.sweep.store")
local fine, e = pcall(function()
  local results = store.open(arg[1])
  results:begin("s", "k = 1")
  results:close()
end)
print(fine and "fine" or tostring(e))
]])
file:close()
for round = 1, 100 do
  local running = {}
  for k = 1, 3 do running[k] = io.popen(("'%s' '%s' '%s/round%d.db' 2>&1"):format(arg[-1], program, folder, round)) end
  for _, pipe in ipairs(running) do
    local said = pipe:read("a")
    pipe:close()
    assert(said == "fine\n", said)
  end
end

os.execute("rm -rf '" .. folder .. "'")
print("passed")
