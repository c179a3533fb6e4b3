-- Wrong inputs of commands that were taken in silence, or refused by a sentence without their name, place or remedy.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = root .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(build, "", "")

runs.write("ball.lua", [[
local k = param("k", 1)
local scene = hooke.scene { duration = 0.1, fps = 10 }
scene:particle { position = { k, 0, 0 } }
scene:force("gravity", { label = "weight" })
scene:force("drag", { rate = 1, label = "drag of air" })
return scene
]])
runs.write("junk", "junk\n")

runs.fails("run ball.lua --resume junk", 'junk is no checkpoint, such as scene:output("checkpoint") writes')
runs.fails("gallery nosuch", "cannot read the list of scenes nosuch: No such file or directory; scripts/gallery.lua is one")
runs.fails("paths nosuch.lua", "hooke: paths: cannot read the scene nosuch.lua: No such file or directory")
runs.refused("validate rods --as springs", "--as goes with --plugin: --plugin X.so --as springs")
runs.refused("fit ball.lua --data x.csv --by k --starts=-1", "--starts: '-1' is not a whole number")
runs.fails("rest ball.lua --without drag", "there is nothing labelled 'drag' to leave out; the scene has weight, drag of air")
runs.refused("help sprngs", "nothing is called 'sprngs'; did you mean 'springs'?") -- the nearest of all words, not of the commands
runs.refused("help bnch", "unknown command 'bnch'; did you mean 'bench'?")
local code, text = runs.run("help gravity drag") -- of several words each
assert(code == 0 and text:find("force 'gravity'", 1, true) and text:find("force 'drag'", 1, true), text)

-- The place is the scene's line, not the module's; a cell as large as the box; a column of times that is not called t.
runs.write("fill.lua", [[
local scene = hooke.scene { duration = 0.1 }
local water = require("filling").box { low = { 0, 0, 0 }, high = { 1, 1, param("high", 1) }, cell = 0.5 }
scene:particles { positions = water.positions, mass = water.mass }
scene:corrector(param("what", "liquid"), { low = { 0, 0, 0 }, high = { 1, 1, 1 }, cell = 2 })
return scene
]])
runs.fails("run fill.lua high=-1 --no-output", "fill.lua:2: filling.box: high is below low, so that there is no room")
runs.fails("run fill.lua --no-output", "fill.lua:4: liquid: cell: 2 m is twice the box along x, 1 m, or more: take smaller cells")
runs.write("times.csv", "time,x\n0,1\n")
runs.write("moving.lua", 'local k = param("k", 1)\nlocal scene = hooke.scene { duration = 0.1 }\nscene:particle {}\n'
  .. 'scene:measure("x", function() return k end)\nreturn scene\n')
runs.fails("fit moving.lua --data times.csv --by k", "times.csv:1: the column 'time' is no measure of the scene; it has x, and a column t")

-- What a run that ends by its constraints has to say: three bars of which one is implied, and masses 5e6 apart in steps that are
-- too long for them (those that are chosen follow the light one).
local function ends(name, options, lines, ...)
  runs.write(name, 'local scene = hooke.scene { duration = 0.5, integrator = "leapfrog" }\n' .. lines
    .. 'scene:pin { 1 }\nscene:force("gravity", {})\nreturn scene\n')
  local ended, said = runs.run(("run %s --no-output --quiet%s"):format(name, options))
  assert(ended == 3, said)
  for _, part in ipairs { ... } do assert(said:find(part, 1, true), said) end
  assert(not said:find("that particle", 1, true), said)
end
ends("bars.lua", "", [[
for k = 0, 2 do scene:particle { position = { k, 0, 0 } } end
scene:constraint("bars", { edges = { { 1, 2 }, { 2, 3 }, { 1, 3 } } })
]], "bars.lua:3: bars: the position of equation", "say the same twice, as a bar along two others does? Leave one out")
ends("masses.lua", " --dt 0.0083", [[
for k = 0, 2 do scene:particle { position = { k, 0, 0 }, mass = ({ 1, 1e-3, 5000 })[k + 1] } end
scene:constraint("bars", { edges = { { 1, 2 }, { 2, 3 } } })
]], "masses.lua:3: bars:", "its particles have masses of 0.001 and 5e+03 kg", "an adaptive integrator")
for _, remedy in ipairs { "--integrator dopri5", "--integrator leapfrog" } do -- those that are named are some
  code, text = runs.run("run masses.lua --no-output --quiet " .. remedy)
  assert(code == 0, text)
end

runs.refused("optimise ball.lua --starts=-2", "--starts: '-2' is not a whole number above 0")

if pcall(require, "luasql.sqlite3") then
  runs.refused("sweep ball.lua k=", "sweep: k: '': a value between the commas is missing")
  runs.refused("sweep ball.lua k=1..2:foo:3", "sweep: k: '1..2:foo:3': 'foo' is neither linear")
  for span, why in pairs { ["99..98:3"] = "from 99 to 98 is in reverse: the lesser end comes first",
    ["10..1:log:3"] = "from 10 to 1 is in reverse", ["99..98:normal:3"] = "from 99 to 98 is in reverse",
    ["9..9:3"] = "3 values from 9 to 9 are one and the same: two ends that differ, or one value",
    ["9..9:random:3"] = "3 values from 9 to 9 are one and the same", ["9..10:1"] = "one value from 9 to 10 would be the first end alone",
    ["9..10:0"] = "is a whole number from 1 to 1000000, not 0", ["9..10:-1"] = "is a whole number from 1 to 1000000, not -1" } do
    runs.refused("sweep ball.lua k=" .. span, why)
  end
  runs.refused("sweep ball.lua --dt 1..x", "sweep: --dt: '1..x': how many values?")
  runs.refused("sweep ball.lua --report", "--report: there is no out/sweep/ball.db: run the sweep first, or name its database with --db")
  runs.fails("sweep ball.lua --merge junk", "cannot merge junk: file is not a database")
end

runs.close()
