-- Steps a second of hooke in WebAssembly (make browser), in Node, beside the program with vectors of two lanes, which are
-- those of WebAssembly, and as it comes, one thread each. Both run a scene in turns, and the least time of each counts.
--   HK_ROOT=. HK_BUILD=build lua5.4 tests/bench/browser.lua [RUNS] [LEAST]
-- LEAST: the ratio to the program of two lanes that has to be reached by every scene; else the exit code is 1.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
local runs, least = tonumber(arg[1]) or 3, tonumber(arg[2]) or 0
local scenes = { { "string", "n=300" }, { "cloth", "N=24" }, { "hair", "strands=4" } }

local function run(command)
  local pipe = assert(io.popen(command))
  local text = pipe:read("a")
  assert(pipe:close(), command .. ": " .. text)
  return tonumber(text:match('"steps":([%d]+)')) / tonumber(text:match('"step_wall_s":([%d.e-]+)')), text
end

local worst = math.huge
print("steps/s          2 lanes     widest  WebAssembly  to 2 lanes  to widest")
for _, s in ipairs(scenes) do
  local scene, values = ("%s/scripts/scenes/%s.lua"):format(root, s[1]), s[2]
  local program = ("%s/hooke run %s %s --no-output --no-check --quiet --threads 1 --json"):format(build, scene, values)
  local commands = { "HOOKE_LANES=2 " .. program, program, ("node %s/tools/browser/node.js %s %s %s"):format(root, build, scene, values) }
  local best = { 0, 0, 0 }
  for _ = 1, runs do
    for k, command in ipairs(commands) do best[k] = math.max(best[k], (run(command))) end
  end
  worst = math.min(worst, best[3] / best[1])
  print(("%-12s %11.0f %10.0f  %11.0f  %10.2f  %9.2f"):format(s[1], best[1], best[2], best[3], best[3] / best[1], best[3] / best[2]))
end
if worst < least then
  print(("failed: %.2f of the program's speed, and %.2f is the least"):format(worst, least))
  os.exit(1)
end
