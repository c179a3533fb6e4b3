-- Runs of scene.lua in each of which one allocation fails, of those of the whole process: hooke's, Lua's, those of plugins
-- and of the libraries that they use (tests/fixtures/failing_memory.c). Held is a run when hooke ends by itself with one
-- of its exit codes; when it ends otherwise than undisturbed, with a sentence on standard error; and when it ends as
-- undisturbed, with the same last state: within 1e-6, for a linear solver without memory may be replaced by another.
-- SUNDIALS 6 writes to memory that it has not got (SUNLogger_Create, ARKodeButcherTable_LoadERK), and HDF5 1.10 tells
-- errors of its own in an endless recursion: there the sentence is that of the handler of crashes, with the plugin's name.
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
    "LD_PRELOAD=%s/tests/fixtures/failing_memory.so %s/hooke run %s %s --threads 1 --out o --state state.csv")
    :format(k > 0 and k or math.maxinteger, quoted(build), quoted(build), quoted(scene), arguments))
  return { code = code, err = read(place .. "/err.txt") or "", state = read(place .. "/state.csv"),
    count = tonumber(read(place .. "/count") or "") }
end

-- Whether two tables of numbers are the same within 1e-6 of their magnitude.
local function same(a, b)
  if a == b or not a or not b then return a == b end
  local next_of_b = b:gmatch("[^,\n]+")
  for text in a:gmatch("[^,\n]+") do
    local x, other = tonumber(text), next_of_b()
    local y = tonumber(other or "")
    if x and not (y and math.abs(x - y) <= 1e-6 * math.max(1, math.abs(x))) then return false end
  end
  return next_of_b() == nil
end

-- What is wrong with that run, or nil.
local function fault(whole, r, crashes)
  if r.code == whole.code then
    return not same(r.state, whole.state) and "another state, without a word in its exit code" or nil
  end
  -- Without the run that would confirm it, a verdict may be stricter, of which a warning says why.
  if whole.code == 0 and r.code == 5 and r.err:find("no memory", 1, true) then return nil end
  if not ({ true, true, false, true })[r.code] then return "it ended by itself" end
  if not r.err:gsub("hooke: warning:[^\n]*", ""):find("hooke: ", 1, true) then return "no word of why" end
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

-- Plugins that crash by the library which they call are named; `of`: of how many runs of the case one is taken, for
-- libraries that allocate ten thousand times.
local cases = {
  { "part=rope --integrator leapfrog" }, { "part=winds --integrator rk4" }, { "part=grains --integrator leapfrog" },
  { "part=sheet --integrator leapfrog" }, { "part=hair --integrator bdf2" }, { "part=links --integrator leapfrog" },
  { "part=water --integrator symplectic_euler" },
  { "part=smoke --integrator symplectic_euler" },
  { "part=drops --integrator symplectic_euler" },
  { "part=solid --integrator backward_euler" }, { "part=rope --integrator backward_euler --solver umfpack" },
  { "part=rope --integrator backward_euler --solver cholmod" }, { "part=rope --integrator backward_euler --solver pcg" },
  { "part=rope --integrator arkode", crashes = "arkode" }, { "part=rope --integrator cvode", crashes = "cvode" },
  { "part=recorded --integrator leapfrog", crashes = "trajectory", of = 12 },
}
-- Every other method, on the rope.
local methods = { "baraff_witkin", "blanes_moan", "desbrun", "dopri5", "esdirk4", "imex", "implicit_midpoint", "linear_bdf2",
  "local_global", "local_leapfrog", "stoermer8", "tr_bdf2", "xpbd" }
for _, name in ipairs(methods) do cases[#cases + 1] = { "part=rope --integrator " .. name, of = 3 } end

-- Every `every`-th allocation of each case. Returns the exit code.
return function(every)
  if build:find("sanitize") then return 77 end -- sanitizers have an allocator of their own
  local pipe = io.popen("mktemp -d /tmp/hooke-allocations-XXXXXX")
  place = pipe:read("l")
  pipe:close()
  local first, faults = run("part=unknown", 0).count, 0
  for _, case in ipairs(cases) do faults = faults + try(case[1], every * (case.of or 1), case.crashes, first) end
  os.execute("rm -rf " .. quoted(place))
  return faults == 0 and 0 or 1
end
