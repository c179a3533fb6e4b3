-- Steps of hooke in WebAssembly (make browser), in Node, a second of a processor, beside the program with vectors of two lanes,
-- which are those of WebAssembly, and as it comes, one thread each. Counted is the time of the processor, of a whole run less of
-- one that ends at its first frames, so that reading and compiling are left out. Where the other half of a core has work of its
-- own, that time doubles for as long as this lasts: the programs run in turns, and the least time of each counts.
--   HK_ROOT=. HK_BUILD=build lua5.4 tests/bench/browser.lua [ROUNDS] [LEAST]
-- LEAST: the ratio to the program of two lanes that every scene has to reach, in as many of the rounds as it needs; one that
-- does not reach it in all of them fails, and the exit code is 1.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
local rounds, least = tonumber(arg[1]) or 3, tonumber(arg[2])
local scenes = { { "string", "n=1000", 10 }, { "cloth", "N=48", 2 }, { "hair", "strands=8", 8 } } -- and to which time, s
local BEGIN = 0.05 -- s of the run that is taken off

-- Seconds of a processor, and steps.
local function run(command)
  local pipe = assert(io.popen(("sh -c '%s; times'"):format(command)))
  local text = pipe:read("a")
  assert(pipe:close(), command)
  local minutes, seconds = text:match("(%d+)m([%d.]+)s %d+m[%d.]+s\n$") -- of what the shell has started
  return 60 * tonumber(minutes) + tonumber(seconds), tonumber(text:match('"steps":(%d+)'))
end

-- Steps a second of each of the commands, from the least times of the rounds; enough(speeds) ends them early.
local function steps_a_second(commands, until_, enough)
  local speeds, seconds, steps = {}, {}, {}
  for _ = 1, rounds do
    for k, command in ipairs(commands) do
      seconds[k], steps[k] = seconds[k] or { math.huge, math.huge }, {}
      for j, time in ipairs { BEGIN, until_ } do
        local taken
        taken, steps[k][j] = run(("%s --until %g"):format(command, time))
        seconds[k][j] = math.min(seconds[k][j], taken)
      end
      speeds[k] = (steps[k][2] - steps[k][1]) / (seconds[k][2] - seconds[k][1])
    end
    if enough(speeds) then break end
  end
  return table.unpack(speeds)
end

local worst = math.huge
print("steps/s          2 lanes     widest  WebAssembly  to 2 lanes  to widest")
for _, s in ipairs(scenes) do
  local scene = ("%s/scripts/scenes/%s.lua %s"):format(root, s[1], s[2])
  local program = ("%s/hooke run %s --no-output --no-check --quiet --threads 1 --json"):format(build, scene)
  local two, widest, web = steps_a_second({ "HOOKE_LANES=2 " .. program, program,
    ("node %s/tools/browser/node.js %s %s"):format(root, build, scene) }, s[3],
    function(speeds) return least and speeds[3] >= least * speeds[1] end)
  worst = math.min(worst, web / two)
  print(("%-12s %11.0f %10.0f  %11.0f  %10.2f  %9.2f"):format(s[1], two, widest, web, web / two, web / widest))
end
if least and worst < least then
  print(("failed: %.2f of the program's speed, and %.2f is the least"):format(worst, least))
  os.exit(1)
end
