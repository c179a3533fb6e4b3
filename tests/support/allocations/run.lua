-- Runs of scene.lua in each of which one allocation fails, of those of the whole process: hooke's, Lua's, those of plugins
-- and of the libraries that they use (tests/fixtures/failing_memory.c). Held is a run when hooke ends by itself with one
-- of its exit codes; when it ends otherwise than undisturbed, with a sentence on standard error; and when it ends as
-- undisturbed, with the same last state, bit by bit. SUNDIALS 6 writes to memory that it has not got (SUNLogger_Create,
-- ARKodeButcherTable_LoadERK): there the sentence is that of the handler of crashes, with the name of the method.
local files = require("files")
local quoted, read = files.quoted, files.read

local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
local scene = root .. "/tests/support/allocations/scene.lua"

local place
local function shell(command)
  local _, how, code = os.execute(("cd %s && { %s; } >out.txt 2>err.txt"):format(quoted(place), command))
  return how == "signal" and 128 + code or code
end

-- The exit code, standard error, last state and number of allocations of a run in which allocation k fails; 0: none.
local function run(arguments, k)
  local code = shell(("rm -rf o state.csv count; OPENBLAS_NUM_THREADS=1 FAILING_MEMORY_COUNT=count FAILING_MEMORY_AT=%d " ..
    "LD_PRELOAD=%s/tests/fixtures/failing_memory.so %s/hooke run %s %s --quiet --threads 1 --out o --state state.csv")
    :format(k > 0 and k or math.maxinteger, quoted(build), quoted(build), quoted(scene), arguments))
  return { code = code, err = read(place .. "/err.txt") or "", state = read(place .. "/state.csv"),
    count = tonumber(read(place .. "/count") or "") }
end

-- What is wrong with that run, or nil.
local function fault(whole, r, crashes)
  if r.code == whole.code then
    return r.state ~= whole.state and "another state, without a word in its exit code" or nil
  end
  if r.code ~= 1 and r.code ~= 2 and r.code ~= 4 then return "it ended by itself" end
  if not r.err:find("hooke: ", 1, true) then return "no word of why" end
  if r.err:find("crashed", 1, true) and not (crashes and r.err:find(("'%s' crashed"):format(crashes), 1, true)) then
    return "a crash"
  end
end

-- Tries every `every`-th allocation after those that a script without a scene takes, with each of the arguments; `crashes`
-- names a method that may crash. Returns the number of faults.
local function try(arguments, every, crashes, first)
  local whole, faults, ended = run(arguments, 0), 0, 0
  assert(whole.code == 0 or whole.code == 5, ("%s: code %d: %s"):format(arguments, whole.code, whole.err))
  for k = first, whole.count, every do
    local r = run(arguments, k)
    local what = fault(whole, r, crashes)
    if r.code ~= whole.code then ended = ended + 1 end
    if what then
      faults = faults + 1
      print(("%s: allocation %d of %d: code %d: %s: %s"):format(arguments, k, whole.count, r.code, what, r.err:sub(-300)))
    end
  end
  print(("%s: allocations %d to %d by %d, %d ended the run"):format(arguments, first, whole.count, every, ended))
  return faults
end

-- cases: { arguments, crashes }. Returns the exit code.
return function(cases, every)
  if build:find("sanitize") then return 77 end -- sanitizers have an allocator of their own
  local pipe = io.popen("mktemp -d /tmp/hooke-allocations-XXXXXX")
  place = pipe:read("l")
  pipe:close()
  local first, faults = run("part=unknown", 0).count, 0
  for _, case in ipairs(cases) do faults = faults + try(case[1], every, case[2], first) end
  os.execute("rm -rf " .. quoted(place))
  return faults == 0 and 0 or 1
end
