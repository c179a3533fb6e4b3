-- hooke refine: measures with half the cell, the sentence of each, the exit code of --within, and what it refuses.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "refine")
local write, refine, refused = runs.write, runs.run, runs.fails

-- A measure of order 1 in the cell that grows in time, one that does not depend on it, and one that the coarse scene alone has.
write("cells.lua", [[
local cell = param("cell", 0.2, "m", { min = 0.05 })
local other = param("other", 1, "")
local name = param("name", "a", "")
local scene = hooke.scene { duration = 0.5, fps = 10, integrator = "leapfrog", dt = 0.1 }
for k = 1, math.floor(1 / cell + 0.5) do scene:particle { position = { k, 0, 0 }, mass = 1 } end
scene:measure("first", function(s) return other * s.t * (1 + cell) end)
scene:measure("same", function() return 3 end)
if cell > 0.15 then scene:measure("coarse", function() return 1 end) end
return scene
]])
local code, text = refine("cells.lua")
assert(code == 0, text)
assert(text:find("cell = 0.2 (5 particles), then 0.1 (10):", 1, true), text)
-- 0.5 x 0.1 of 0.5 x 1.2 at the end
assert(text:find("first: 0.6, then 0.55 at the end; the largest difference is 8.3 % of its largest value, at t = 0.5 s", 1, true),
  text)
assert(text:find("same: 3 in both", 1, true), text)
assert(text:find("coarse is a measure of one of the two alone", 1, true), text)

code, text = refine("cells.lua cell=0.4 other=2 --until 0.2 --within 0.2")
assert(code == 0 and text:find("then 0.2 (", 1, true) and text:find("first: 0.56, then 0.48", 1, true), text)
code, text = refine("cells.lua cell=0.4 --until 0.2 --within 0.1")
assert(code == 5 and text:find("inaccurate: first changes by 14 %, more than --within allows (10 %): take a smaller cell", 1, true), text)
code, text = refine("cells.lua --of other")
assert(code == 0 and text:find("other = 1 (5 particles), then 0.5 (5)", 1, true), text)

write("blind.lua", [[
local cell = param("cell", 1, "m")
local scene = hooke.scene { duration = 0.1, fps = 10 }
scene:particle { position = { cell, 0, 0 }, mass = 1 }
return scene
]])
write("falls.lua", [[
local cell = param("cell", 1, "m")
if cell < 1 then error("no room") end
local scene = hooke.scene { duration = 0.1, fps = 10 }
scene:particle { position = { cell, 0, 0 }, mass = 1 }
scene:measure("one", function() return 1 end)
return scene
]])
refused("", "missing argument 'scene'")
refused("none.lua", "none.lua")
refused("cells.lua --of cel", "the scene has no parameter 'cel'; did you mean 'cell'?")
refused("cells.lua --of speed", "it has cell, other, name: name the one that is halved, --of NAME")
refused("cells.lua --of name", "--of: name is no number, but a string")
refused("cells.lua cell=0.08", "--of: half of cell, 0.04, is below the least that the scene takes, 0.05: begin with cell=0.1 or more")
refused("cells.lua other=-1 --of other", "--of: other is -1, and only what is above 0 is halved")
refused("cells.lua --within 0", "--within: '0' is not a positive number")
refused("blind.lua", "the scene has no measure that could be compared")
code, text = refine("falls.lua")
assert(code == 3 and text:find("with cell = 0.5: ", 1, true) and text:find("no room", 1, true), text)

runs.close()
