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
runs.refused("validate rods --as springs", "--as goes with --plugin: --plugin X.so --as springs")
runs.refused("fit ball.lua --data x.csv --by k --starts=-1", "--starts: '-1' is not a whole number")
runs.fails("rest ball.lua --without drag", "there is nothing labelled 'drag' to leave out; the scene has weight, drag of air")
runs.refused("help sprngs", "nothing is called 'sprngs'; did you mean 'springs'?") -- the nearest of all words, not of the commands
runs.refused("help bnch", "unknown command 'bnch'; did you mean 'bench'?")
local code, text = runs.run("help gravity drag") -- of several words each
assert(code == 0 and text:find("force 'gravity'", 1, true) and text:find("force 'drag'", 1, true), text)

if pcall(require, "luasql.sqlite3") then
  runs.refused("sweep ball.lua k=", "sweep: k: '': a value between the commas is missing")
  runs.refused("sweep ball.lua k=1..2:foo:3", "sweep: k: '1..2:foo:3': 'foo' is neither linear")
  runs.refused("sweep ball.lua --dt 1..x", "sweep: --dt: '1..x': how many values?")
  runs.refused("sweep ball.lua --report", "--report: there is no out/sweep/ball.db: run the sweep first, or name its database with --db")
  runs.fails("sweep ball.lua --merge junk", "cannot merge junk: file is not a database")
end

runs.close()
