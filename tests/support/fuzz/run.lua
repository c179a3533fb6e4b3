-- Runs random cases of one kind and judges hooke by each: it ends by itself with one of its exit codes, no sanitizer
-- complains, an error comes with a sentence that names a cause, and what is printed is text. A case follows from the seed
-- and its number alone:
--   lua5.4 tests/fuzz/scenes.lua                       the short form, of `make test`
--   lua5.4 tests/fuzz/scenes.lua --seconds 600 --seed 7
--   lua5.4 tests/fuzz/scenes.lua --seed 7 --case 31    one of them; --keep leaves its folder
local files = require("files")

local run = {}

local root, build = assert(os.getenv("HK_ROOT")), assert(os.getenv("HK_BUILD"))
run.hooke = build .. "/hooke"
run.seconds, run.grace = 4, 10 -- s until SIGINT, and from there on until it counts as a hang
local own_codes = { [0] = "ok", "wrong use", "plugin failed", "diverged", "file error", "inaccurate", [130] = "interrupted",
  [124] = "interrupted" }
local broken = 99 -- exit code of the sanitizers

local function shell(command)
  local pipe = assert(io.popen(command))
  local text = pipe:read("a")
  pipe:close()
  return text
end

local quoted, write = files.quoted, files.write
local function read(path) return files.read(path) or "" end

-- Fixtures that keep their contract, as plugins, so that constraints, correctors and sources are among those known.
local function install_fixtures(place)
  local kinds = { constraints = "bar cord ground telescope", correctors = "floor rejecter", sources = "spout sower",
    forces = "area_springs volume_springs barrier_spheres crowd_drag lagged_friction lennard_jones", solvers = "counting_solver" }
  for kind, names in pairs(kinds) do
    shell(("mkdir -p %s/plugins/%s"):format(place, kind))
    for name in names:gmatch("%S+") do
      shell(("cp %s/tests/fixtures/%s.so %s/plugins/%s/"):format(build, name, place, kind))
    end
  end
end

function run.open(place)
  local options = "exitcode=99:allocator_may_return_null=1:abort_on_error=0:intercept_tls_get_addr=0" -- tests/run has why
  local leaks = ("suppressions=%s/tests/leaks.txt:print_suppressions=0"):format(root)
  install_fixtures(place)
  run.before = ("export HOOKE_PLUGIN_PATH=%s/plugins XDG_CACHE_HOME=%s/cache ASAN_OPTIONS=%s UBSAN_OPTIONS=%s LSAN_OPTIONS=%s; ")
    :format(place, place, options, options, leaks)
end

-- Runs a case in its folder; what it said and its exit code.
local function try(case, folder)
  shell(("rm -rf %s && mkdir -p %s"):format(folder, folder))
  for name, text in pairs(case.files) do write(folder .. "/" .. name, text) end
  local command = ("cd %s && { %s timeout -s INT -k %d %d %s %s %s; } >.out 2>.err </dev/null; echo $?"):format(folder,
    run.before, run.grace, case.seconds or run.seconds, case.before or "", run.hooke, case.words)
  local code = tonumber(shell(command))
  return code, read(folder .. "/.out"), read(folder .. "/.err")
end

-- Whether the sanitizer's stack begins in that library.
local function falls_in(err, library)
  for line in err:gmatch("\n *#%d+ [^\n]+") do
    if not line:lower():find("sanitizer") and not line:find("__asan", 1, true) and not line:find("__interceptor", 1, true) then
      return line:find(library, 1, true) ~= nil
    end
  end
  return false
end

local function is_text(said) return utf8.len(said) and not said:find("[%z\1-\8\11-\31\127]") end

-- What is wrong with what hooke did; nil: nothing.
local function complaint(code, out, err, case)
  if code == 137 then return "it hangs" end
  if case.library and falls_in(err, case.library) then return nil end
  if code == broken or err:find("Sanitizer", 1, true) or err:find("runtime error:", 1,
    true) then return "a sanitizer complains" end
  if not own_codes[code] then return ("exit code %d"):format(code) end
  if code >= 1 and code <= 4 and not err:find("hooke: [^\n]*%S") then return ("exit code %d without a sentence"):format(code) end
  if not is_text(out) or not is_text(err) then return "what it prints is no text" end
  if err:find("(null)", 1, true) or err:find(": Success", 1, true) or err:find(": *\n") then return "an error without a cause" end
  if err:find("SIG%u+,") then return "a plugin crashed" end
  if case.says and not err:find(case.says, 1, true) then return ("it does not say '%s'"):format(case.says) end
  if case.code and code ~= case.code then return ("exit code %d instead of %d"):format(code, case.code) end
  return case.check and case.check(code, out, err)
end

local function options_of(words)
  local o = { seed = 1 }
  for k = 1, #words do
    local name = words[k]:match("^%-%-(%l+)$")
    if name == "keep" then o.keep = true
    elseif name then o[name] = assert(tonumber(words[k + 1]), words[k]) end
  end
  return o
end

local function show(what, why, folder, words, err)
  print(("FELL  %s: %s\n      hooke %s   (in %s)"):format(what, why, words, folder))
  for line in (err:sub(1, 1500) .. "\n"):gmatch("([^\n]+)\n") do print("      | " .. ("%q"):format(line)) end
end

local function count_of(codes)
  local list = {}
  for code, count in pairs(codes) do list[#list + 1] = ("%d %s"):format(count, own_codes[code] or code) end
  table.sort(list)
  return table.concat(list, ", ")
end

-- Tries the cases that were found earlier, { name, files =, words =, code =, says = }, and random ones.
local function all(t, o, place, judge)
  for _, case in ipairs(o.case and {} or t.found or {}) do judge(case[1], case, place .. "/found") end
  local finish, k = o.seconds and os.time() + o.seconds, o.case or 1
  while o.case and k == o.case or not o.case and (finish and os.time() < finish or not finish and k <= t.cases) do
    math.randomseed(o.seed, k)
    judge(("--seed %d --case %d"):format(o.seed, k), t.make(k), place .. "/case")
    k = k + 1
  end
  return k - 1
end

-- t: name, cases (of the short form), make(number) -> { files = { [name] = text }, words = of the command line }, found.
function run.fuzz(t)
  local o, fell, codes = options_of(arg), 0, {}
  local place = shell("mktemp -d /tmp/hooke-fuzz-XXXXXX"):gsub("%s", "")
  io.stdout:setvbuf("line")
  run.open(place)
  if t.prepare then t.prepare(place) end
  local function judge(what, case, folder)
    local code, out, err = try(case, folder)
    local why = complaint(code, out, err, case)
    codes[code] = (codes[code] or 0) + 1
    if o.case then print(("%s\nexit code %d\n%s%s"):format(case.words, code, out, err)) end
    if not why then return end
    fell = fell + 1
    local kept = ("%s/fuzz/%s-%d"):format(build, t.name, fell)
    shell(("rm -rf %s; mkdir -p %s/fuzz; cp -r %s %s"):format(kept, build, folder, kept))
    show(("%s: %s"):format(t.name, what), why, kept, case.words, err)
  end
  local count = all(t, o, place, judge)
  if not o.keep then shell("rm -rf " .. quoted(place)) else print(place) end
  print(("%s: %d cases, %d fell; %s"):format(t.name, count, fell, count_of(codes)))
  os.exit(fell == 0)
end

return run
