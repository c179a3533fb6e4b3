-- hooke fit and optimise that the user interrupts (SIGINT, SIGTERM): one closing sentence that says what the best is, where it is kept and
-- how it goes on, exit code 130 as hooke run, no process left, and the same command ends where one that was not interrupted does.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local tool_runs = require("tool_runs")
local build = assert(os.getenv("HK_BUILD"), "HK_BUILD")

-- Sends the signal when the file `path` has something in it, and ends as the tool does.
local function when(path, signal)
  return ("sh -c '\"$@\" & p=$!; while [ ! -s %s ] && kill -0 $p 2>/dev/null; do sleep 0.01; done; kill -%s $p; wait $p' sh"):format(
    path, signal)
end

-- No sleep of a run: steps that take their time.
local body = [[
local k = param("k", 30, "N/m")
local scene = hooke.scene { duration = 1, fps = 20, integrator = "leapfrog", dt = %s }
local p = scene:particle { position = { 1, 0, 0 } }
%s
scene:measure("x", function(s) return s:position(p)[1] end)
scene:measure("v", function(s) return s:velocity(p)[1] end)
return scene
]]

-- ---- fit ----

local fit = tool_runs.new(build, "fit", "--quiet --no-diagrams")
fit.write("slow.lua", body:format("1e-5", [[scene:force("central", { strength = k, per = "particle" })]]))
fit.write("slow.csv", "t,x\n0.2,0.2\n0.3,-0.3\n0.5,-0.9\n")
local command = "slow.lua --data slow.csv --by k --jobs 2 --out "
for _, signal in ipairs { "INT", "TERM" } do
  local code, text = fit.run(command .. signal, when(signal .. "/now.txt", signal))
  local words = "^hooke: fit: interrupted: the best so far, k = [%d.]+ with a sum of squares of "
  assert(code == 130 and not text:find("\n.") and text:find(words), ("exit %d: %s"):format(code, text))
  assert(text:find(("stands in %s/now.txt, and %%d+ runs are kept in %s/runs.json, from which the same command goes on"):format(signal,
    signal)), text)
  local value = text:match("k = ([%d.]+)")
  assert(math.abs(tonumber(fit.read(signal .. "/now.txt"):match("k=([%d.]+)")) / tonumber(value) - 1) < 1e-8, text)
  assert(fit.read(signal .. "/runs.json"):find('"values"', 1, true), "the runs are kept")
end
local code, again = fit.run(command .. "INT")
local _, whole = fit.run(command .. "whole")
assert(code == 0 and again:match("\n  k +(%S+)") == whole:match("\n  k +(%S+)"), again .. whole)
assert(tonumber(again:match("(%d+) runs")) < tonumber(whole:match("(%d+) runs")), again .. whole)
code, again = fit.run("slow.lua --data slow.csv --by k --out early", when("early/runs.json", "INT"))
assert(code == 130 and (again:find("^hooke: fit: interrupted before its first iteration: %d+ runs? [ia][sr]e? ?kept in early/")
  or again:find("^hooke: fit: interrupted before its first run: nothing is kept")), again)

-- A signal to the process of one case is that case's: it fails, and the fit is not taken for interrupted.
local to_child = "sh -c '\"$@\" & p=$!; c=; while [ -z \"$c\" ] && kill -0 $p; do read c rest < /proc/$p/task/$p/children; done; "
  .. "kill -TERM $c; wait $p' sh"
code, again = fit.run("slow.lua --data slow.csv --by k --jobs 2 --out child", to_child)
assert(code ~= 130 and again:find("signal 15") and not again:find("interrupted"), ("exit %d: %s"):format(code, again))
fit.close()

-- ---- optimise, by both ways ----

local optimise = tool_runs.new(build, "optimise", "--quiet")
local pushed = [[
local u = scene:control("push", { knots = 5 })
scene:force("central", { strength = 3, power = 3 })
scene:force("gravity", { g = function(t) return k / 30 * u(t), 0, 0 end })]]
optimise.write("push.lua", body:format("2e-5", pushed))
for _, way in ipairs { "shooting", "transcription" } do
  command = ("push.lua --goal x=0.5,v=0.3 --way %s --out "):format(way)
  code, again = optimise.run(command .. way, when(way .. "/now-push.txt", "INT"))
  assert(code == 130 and not again:find("\n.") and
    again:find("^hooke: optimise: interrupted: the controls of the moment, with a cost of [%d.e+-]+ and goals missed by "), again)
  assert(again:find(("stand in %s/now-push.txt, and what was evaluated is kept in %s/evaluations.json, from which the same "
    .. "command goes on"):format(way, way), 1, true), again)
  code, again = optimise.run(command .. way)
  _, whole = optimise.run(command .. "whole")
  assert(code == 0 and again:match("optimum 1: [^,]*") == whole:match("optimum 1: [^,]*"), again .. whole)
end
optimise.close()
