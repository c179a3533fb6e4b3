-- Steps of hooke in WebAssembly (make browser), in Node, a second of a processor, beside the program with vectors of two lanes,
-- which are those of WebAssembly, and as it comes, one thread each. Counted is the time of the processor, which a busy machine
-- changes little; of a whole run less of one that ends at its first frames, so that reading and compiling are left out. They
-- run in turns, and the least time of each counts.
--   HK_ROOT=. HK_BUILD=build lua5.4 tests/bench/browser.lua [RUNS] [LEAST]
-- LEAST: the ratio to the program of two lanes that has to be reached by every scene; else the exit code is 1.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
local runs, least = tonumber(arg[1]) or 3, tonumber(arg[2]) or 0
local scenes = { { "string", "n=1000", 3 }, { "cloth", "N=48", 1 }, { "hair", "strands=8", 1 } } -- and to which time, s
local BEGIN = 0.05 -- s of the run that is taken off

-- Seconds of a processor, and steps.
local function run(command)
  local pipe = assert(io.popen(("sh -c '%s; times'"):format(command)))
  local text = pipe:read("a")
  assert(pipe:close(), command)
  local minutes, seconds = text:match("(%d+)m([%d.]+)s %d+m[%d.]+s\n$") -- of what the shell has started
  return 60 * tonumber(minutes) + tonumber(seconds), tonumber(text:match('"steps":(%d+)'))
end

local function steps_a_second(command, until_)
  local first, last, steps = math.huge, math.huge, {}
  for _ = 1, runs do
    local seconds
    seconds, steps[1] = run(("%s --until %g"):format(command, BEGIN))
    first = math.min(first, seconds)
    seconds, steps[2] = run(("%s --until %g"):format(command, until_))
    last = math.min(last, seconds)
  end
  return (steps[2] - steps[1]) / (last - first)
end

local worst = math.huge
print("steps/s          2 lanes     widest  WebAssembly  to 2 lanes  to widest")
for _, s in ipairs(scenes) do
  local scene = ("%s/scripts/scenes/%s.lua %s"):format(root, s[1], s[2])
  local program = ("%s/hooke run %s --no-output --no-check --quiet --threads 1 --json"):format(build, scene)
  local two, widest = steps_a_second("HOOKE_LANES=2 " .. program, s[3]), steps_a_second(program, s[3])
  local web = steps_a_second(("node %s/tools/browser/node.js %s %s"):format(root, build, scene), s[3])
  worst = math.min(worst, web / two)
  print(("%-12s %11.0f %10.0f  %11.0f  %10.2f  %9.2f"):format(s[1], two, widest, web, web / two, web / widest))
end
if worst < least then
  print(("failed: %.2f of the program's speed, and %.2f is the least"):format(worst, least))
  os.exit(1)
end
