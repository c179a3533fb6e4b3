-- Units of measures and parameters: what a scene says of them is in the summary, in databases and tables of sweeps, on the axes of
-- diagrams and in recordings, and data in other units are refused.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tests/support/?.lua;%s/tools/?.lua;"):format(root, root) .. package.path
for _, name in ipairs { "luasql.sqlite3", "lfs", "argparse", "cjson" } do
  if not pcall(require, name) then
    print("skipped: Lua's " .. name .. " is not installed")
    os.exit(77)
  end
end
local json = require("cjson")
local units = require("common.run.units")
local runs = require("tool_runs").new(build, "sweep")

local function has(text, wanted) assert(text:find(wanted, 1, true), ("'%s' is not in:\n%s"):format(wanted, text)) end

-- ---- of a help ----

for help, unit in pairs { ["stiffness, N/m"] = "N/m", ["damping of a spring, N s/m"] = "N s/m", s = "s",
  ["rad/s, about the stem"] = "rad/s",
  ["gravity, m/s^2"] = "m/s^2", ["spins, kg m²/s"] = "kg m²/s", ["rate, 1/s"] = "1/s", ["a, b, Pa"] = "Pa" } do
  assert(units.of_help(help) == unit, ("%s: %s"):format(help, units.of_help(help)))
end
for _, help in ipairs { "", "particles", "grid, incompressible or sph", "of the spin, about the other axes",
  "impulses, barrier, force, zones", "1", "0: the start is refused", "m/q" } do
  assert(units.of_help(help) == nil, help)
end
assert(units.of_help(nil) == nil)
assert(units.quotient("m", "N/m") == "m/(N/m)" and units.quotient("m", "s") == "m/s" and not units.quotient("m", nil))
assert(units.of_heading("sag [m]") == "sag" and select(2, units.of_heading("sag [m]")) == "m" and select(2, units.of_heading("sag")) == nil)

-- ---- of a run ----

local scene = [[
local k, n = param("k", 40, "stiffness, N/m"), param("n", 1, "how often")
local scene = hooke.scene { duration = 0.2, fps = 20, dt = 0.01, integrator = "leapfrog" }
local hook, weight = scene:particle {}, scene:particle { position = { 0, 0, -1 } }
scene:pin { hook }
scene:force("gravity")
scene:force("springs", { edges = { { hook, weight } }, k = k })
scene:measure("sag", function(s) return -s:position(weight)[3] end, { unit = "m" })
scene:measure("times", function() return n * k end)
scene:goal { particle = weight, velocity = { 0, 0, 0 } }
scene:output("trajectory")
return scene
]]
runs.write("hung.lua", scene)
local code, said = runs.hooke("run hung.lua --json --quiet")
assert(code == 0 or code == 5, said)
local summary = json.decode(said:match("{.*}"))
assert(summary.measure_units.sag == "m" and summary.measure_units["vz[2]"] == "m/s" and summary.measure_units.times == nil, said)
code, said = runs.hooke("run hung.lua --no-output")
assert(code == 0 or code == 5, said)
assert(said:find("\n  sag  +1%.%d+ m\n") and said:find("\n  times  +40\n"), said)

-- ---- refused in one sentence, at the line ----

for wrong, wanted in pairs {
  ['{ unit = "[m]" }'] = "unit of 'sag': expected a plain text of at most 24 characters",
  ['{ unit = "m\\n" }'] = "unit of 'sag': expected a plain text",
  ['{ unit = "' .. ("m"):rep(25) .. '" }'] = "unit of 'sag': expected a plain text",
  ['{ unit = "1" }'] = "leave it out for a pure number",
  ["{ unit = 3 }"] = "unit of 'sag': expected a text",
  ["{ units = 'm' }"] = "did you mean 'unit'?",
  ['"m"'] = 'options are a table, scene:measure("sag", f, { unit = "m" })',
} do
  runs.write("wrong.lua", (scene:gsub('{ unit = "m" }', (wrong:gsub("%%", "%%%%")))))
  code, said = runs.hooke("run wrong.lua --no-output --quiet")
  assert(code == 1 and select(2, said:gsub("\n", "")) == 1, said)
  has(said, "wrong.lua:7: measure: ")
  has(said, wanted)
end

-- ---- of a sweep: database, table, CSV and axes; a database without units ----

code, said = runs.run("hung.lua k=40,50,60 --csv all.csv --plot sag:k --plot dt_max:k --quiet --db all.db")
assert(code == 0, said)
has(runs.read("all.csv"):match("[^\n]*"), "sag [m],times")
local line = runs.read("all-sag-k.gp")
has(line, "set xlabel 'k, N/m'")
has(line, "set ylabel 'sag, m'")
has(runs.read("all-dt_max-k.gp"), "set ylabel 'dt_max, s'")
local db = require("luasql.sqlite3").sqlite3():connect(runs.folder .. "/all.db")
local function value(sql)
  local cursor = assert(db:execute(sql))
  local found = cursor:fetch()
  cursor:close()
  return found
end
assert(value("PRAGMA user_version") == 1 or value("PRAGMA user_version") == "1")
assert(value("SELECT unit FROM units WHERE name = 'sag' LIMIT 1") == "m")
assert(value("SELECT unit FROM units WHERE name = 'k' LIMIT 1") == "N/m")
code, said = runs.run("hung.lua k=40,50 --verify --plot sag:k --quiet --db checked.db")
assert(code == 0, said)
has(runs.read("checked-sag-k.gp"), "set xlabel 'k, N/m'")
assert(db:execute("DROP TABLE units")) -- as a hooke that knew none left it
db:close()
code, said = runs.run("hung.lua k=40,50,60 --report --csv old.csv --plot sag:k --quiet --db all.db")
assert(code == 0, said)
has(runs.read("old.csv"):match("[^\n]*"), "sag,times")
has(runs.read("all-sag-k.gp"), "set ylabel 'sag'")
code, said = runs.run("hung.lua k=70 --merge all.db --db new.db --quiet")
assert(code == 0, said)

-- ---- of gradients, fits and pages ----

code, said = runs.hooke("gradient hung.lua --of sag --by k --out g")
assert(code == 0, said)
has(said, "in m/(N/m); stiffness, N/m")
has(runs.read("g/gradient.gp"), "set ylabel 'd(sag)/d(ln parameter), m'")
local found = json.decode((runs.read("g/gradient.json")))
assert(found.unit == "m" and found.parameters[1].derivative_unit == "m/(N/m)")

runs.write("data.csv", "t [s],sag [m]\n0.1,1.048\n0.15,1.107\n0.2,1.187\n")
code, said = runs.hooke("fit hung.lua --data data.csv --by k --out f")
assert(code == 0 or code == 2, said)
has(runs.read("f/sag.gp"), "set ylabel 'sag, m'")
has(runs.read("f/fit.residuals.gp"), "set ylabel 'fit - data, m'")
runs.write("data.csv", "t,sag [cm]\n0.1,104.8\n0.2,118.7\n")
code, said = runs.hooke("fit hung.lua --data data.csv --by k --out f")
assert(code == 1, said)
has(said, "data.csv:1: the column 'sag [cm]' is in cm, and the scene has sag in m: convert it")

code, said = runs.hooke("view out/hung")
assert(code == 0, said)
has(runs.read("out/hung/page.html"), '"unit":"m"')

-- ---- of a live page ----

local run = require("common.watch.messages").run("fps\t50\nmeasure\tsag\tm\nmeasure\ttimes\t\n")
assert(table.concat(run.measures, ",") == "sag,times" and table.concat(run.units, ",") == "m,")
runs.close()
print("passed")
