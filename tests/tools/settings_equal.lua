-- hooke sweep and hooke bench say when settings were equal in effect, and sweep what its runs were warned of: steps above a frame
-- are cut to it, by explicit and implicit methods, and a parameter that nothing uses changes nothing. What differs is not said to
-- be equal. An unknown parameter of --vary and an unknown --metric are refused before anything is run.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/support/?.lua;%s/tools/?.lua;%s"):format(root, root, package.path)
if not pcall(require, "luasql.sqlite3") then
  print("skipped: Lua's luasql.sqlite3 is not installed")
  os.exit(77)
end
local tool_runs = require("tool_runs")
local sweep, bench = tool_runs.new(build, "sweep", "-j 2"), tool_runs.new(build, "bench", "--quiet")

local scene = [[
local strength = param("strength", 1, "N/m", { min = 0 })
local shade = param("shade", 1, "that nothing uses")
local scene = hooke.scene { duration = 0.2, fps = 10, integrator = "rk4", dt = 0.1 }
local p = scene:particle { position = { 1, 0, 0 } }
scene:force("central", { strength = strength })
scene:measure("place", function(s) return s:position(p)[1] end)
return scene
]]
sweep.write("ball.lua", scene)
bench.write("ball.lua", scene)

local function has(text, wanted) assert(text:find(wanted, 1, true), ("no '%s' in: %s"):format(wanted, text)) end
local function has_not(text, other) assert(not text:find(other, 1, true), ("'%s' in: %s"):format(other, text)) end

-- ---- sweep ----

local same = "end with the same positions, velocities, steps and measures, to the last bit"
local count = 0
local function swept(arguments)
  count = count + 1
  local code, text = sweep.run(("ball.lua %s --db %d.db"):format(arguments, count))
  assert(code == 0, text)
  return text
end

for _, method in ipairs { "rk4", "backward_euler" } do
  local text = swept("--dt 0.05,0.2,0.4 --integrators " .. method)
  has(text, "warning, cases 2, 3: the first was told: dt = 0.2 s is longer than a frame of 0.1 s")
  has(text, "equal in effect, cases 2, 3: dt = 0.2 | dt = 0.4 " .. same)
end
swept("--dt 0.05,0.2,0.4 --plot place:dt") -- the end of its line is flat, and the title says why
has(sweep.read(count .. "-place-dt.gp"), "2 of 3 cases are equal to others in effect")
has(swept("shade=1,2"), "equal in effect, cases 1, 2: shade = 1 | shade = 2 " .. same)
has_not(swept("strength=1,2"), "equal in effect")
has_not(swept("strength=1 --dt 0.1 --repeats 2"), "equal in effect") -- a repeat is no setting
local many = swept("strength=1,2,3,4,5,6 shade=1,2")
has(many, "equal in effect: 2 more groups")

-- Parts that are merged keep what was said, and a part by a hooke that kept nothing of it is merged as well.
local function done(arguments) assert(sweep.run("ball.lua --dt 0.2,0.4 " .. arguments) == 0, arguments) end
done("--case 1 --part a.db")
done("--case 2 --part b.db")
local code, text = sweep.run("ball.lua --dt 0.2,0.4 --merge a.db --merge b.db --db both.db")
assert(code == 0, text)
has(text, "warning, cases 1, 2: ")
has(text, "equal in effect, cases 1, 2: ")
local sql = require("luasql.sqlite3").sqlite3():connect(sweep.folder .. "/b.db")
assert(sql:execute("DROP TABLE states") and sql:execute("DROP TABLE warnings"))
sql:close()
code, text = sweep.run("ball.lua --dt 0.2,0.4 --merge a.db --merge b.db --db again.db")
assert(code == 0, text)
has(text, "2 ok")
has(text, "warning, case 1: dt = 0.2 s")
has_not(text, "equal in effect")

-- ---- bench ----

-- Of tolerances the steps tell: the second and third are equal, the fourth is not; of a motion without errors nothing is known.
local equal = require("common.bench.equal")
local function row(tol, steps, error)
  return { setting = { tol = tol }, verdict = "ok", result = { steps = steps, force_evaluations = 7 * steps },
    errors = { x_rms = error, x_max = error, v_rms = error, v_max = error, measure = {} } }
end
local found = equal.settings { { label = "a", rows = { row(1e-2, 3, 0.1), row(1e-3, 4, 0.01), row(1e-4, 4, 0.01), row(1e-5, 5, 0.01) } },
  { label = "b", rows = { row(1e-2, 3, 0), row(1e-3, 3, 0) } } }
assert(#found == 1 and found[1].label == "a" and table.concat(found[1].settings, " ") == "tol 0.001 tol 0.0001")
local groups = equal.methods { { label = "a", rows = { row(1e-2, 3, 0.1), row(1e-3, 4, 0.01) } },
  { label = "b", rows = { row(1e-3, 4, 0.01) } },
  { label = "c", rows = { row(1e-2, 3, 0.1), row(1e-3, 4, 0.02) } }, { label = "d", rows = { row(1e-2, 3, 0) } } }
assert(#groups == 1 and table.concat(groups[1], " ") == "a b")

code, text = bench.run("ball.lua --integrators leapfrog --vary shade=1,2 --budget 1 --out b")
assert(code == 0, text)
has(text, "equal in effect: leapfrog shade=1 | leapfrog shade=2 have the same errors, steps and evaluations, to the last bit")
has(bench.read("b/bench.json"), '["leapfrog shade=1","leapfrog shade=2"]')
code, text = bench.run("ball.lua --integrators leapfrog --vary strength=1,2 --budget 1 --out b")
assert(code == 0, text)
has_not(text, "equal in effect: leapfrog strength=1 |")
bench.fails("ball.lua --vary tint=1,2", "--vary tint=1: ball.lua has no parameter 'tint'")
bench.fails("ball.lua --vary strength=1,-2", "--vary strength=-2: ball.lua:1: parameter strength: -2 is below the minimum 0")
bench.fails("ball.lua --metric plaec", "--metric plaec: the scene has no such measure, did you mean 'place'?")
bench.fails("ball.lua --until 0", "--until: '0' is not a positive number")

sweep.close()
bench.close()
