-- Diagrams of a sweep in panels: one for each value of a parameter, on the same axes, each line with the same look in all, and one
-- legend.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = root .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(build, "sweep", "--quiet")

runs.write("point.lua", [[
local kind, method, n = param("kind", "a"), param("method", "x"), param("n", 1)
local scene = hooke.scene { duration = 0.1 }
scene:particle { position = { n, kind == "a" and 0 or 1, method == "x" and 0 or 1 } }
scene:measure("cost", function() return n * (kind == "a" and 1 or 2) end)
scene:measure("error", function() return n ^ -2 * (method == "x" and 1 or 3) end)
return scene
]])
local plan = [[
return hooke.sweep { scene = "point.lua", params = { kind = { "a", "b", "c" }, method = { "x", "y" }, n = { 1, 2, 4 } }, verify = false,
  plots = { { name = "lines", measure = "error", over = "cost", along = "n", panels = { "%s" }, logx = true, logy = true } } }
]]

runs.write("panels.lua", plan:format("kind"))
local code, said = runs.run("panels.lua")
assert(code == 0, said)
local script = runs.read("out/sweep/panels-lines.gp")
assert(script:find("set multiplot layout 2,2", 1, true), script)
for _, kind in ipairs { "a", "b", "c" } do assert(script:find(("set title 'kind = %s'"):format(kind), 1, true), script) end
assert(select(2, script:gsub("set yrange", "")) == 1 and select(2, script:gsub("set xrange", "")) == 1, script)
assert(select(2, script:gsub("keyentry ", "")) == 2 and script:find("title 'method = y'", 1, true), script)
assert(select(2, script:gsub(" ls 2 notitle", "")) == 3, script) -- y has the second style in each of the three
-- Every point of 18 is inside the one range: errors from 1/16 to 3, costs from 1 to 8.
local low, high = script:match("set yrange %[([%d.e+-]+):([%d.e+-]+)%]")
assert(tonumber(low) < 1 / 16 and tonumber(high) > 3, script)
low, high = script:match("set xrange %[([%d.e+-]+):([%d.e+-]+)%]")
assert(tonumber(low) < 1 and tonumber(high) > 8, script)

runs.write("none.lua", plan:format("nothing"))
runs.refused("none.lua", "plots: panels: 'nothing' is not a parameter of the sweep")
runs.close()
print("passed")
