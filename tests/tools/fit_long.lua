-- hooke fit as a user meets it: stiffness and damping from a motion given by its formula, a minimum beside the best one,
-- parameters that the data cannot tell, an interrupted fit that goes on, and what is refused before the first run.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "fit", "--quiet")
local write, read, fit, refused = runs.write, runs.read, runs.run, runs.refused

local function value(text, name)
  local found, sd, steps = text:match("\n  " .. name .. " +(%S+) +(%S+) +(%S+)")
  return tonumber(found), tonumber(sd), tonumber(steps)
end

-- ---- a motion that is known: x'' = -w2 x - g x' ----

write("swing.lua", [[
local w2 = param("w2", 30, "stiffness by mass, 1/s2", { min = 1, max = 400 })
local g = param("g", 0.3, "drag by mass, 1/s", { min = 0 })
local weight = param("weight", 1, "mass, kg", { min = 0.1 })
local scene = hooke.scene { duration = 3, fps = 10, integrator = "rk4" }
local p = scene:particle { position = { 0.1, 0, 0 }, mass = weight }
local o = scene:particle { position = { 0, 0, 0 } }
scene:pin { o }
scene:force("springs", { edges = { { p, o } }, k = w2 * weight, rest = 0 })
scene:force("drag", { d = g * weight })
scene:measure("x", function(s) return s:position(p)[1] end)
scene:measure("speed", function(s) return s:velocity(p)[1] end)
return scene
]])
local lines, w2, g = { "# made by the formula", "t,x" }, 37.3, 0.45
local w = math.sqrt(w2 - g * g / 4)
for k = 1, 50 do
  local t = 0.055 * k + 0.001 * (k % 3) -- between frames
  lines[#lines + 1] = ("%.17g,%.17g"):format(t, 0.1 * math.exp(-g * t / 2) * (math.cos(w * t) + g / 2 / w * math.sin(w * t)))
end
write("motion.csv", table.concat(lines, "\n") .. "\n")

local code, text = fit("swing.lua --data motion.csv --by w2,g --accuracy 1e-6")
assert(code == 0, text)
local found, _, steps = value(text, "w2")
assert(math.abs(found - w2) <= steps and steps <= 1e-6 * w2, text) -- the part of the steps that it says is what is wrong
found, _, steps = value(text, "g")
assert(math.abs(found - g) <= steps and steps <= 1e-6 * g, text)
local json = read("out/fit/swing/fit.json")
assert(json:find('"sure":true', 1, true), json)
assert(select(2, read("out/fit/swing/fit.csv"):gsub("\n", "\n")) == 51)
assert(read("out/fit/swing/x.gp"):find("w2 = 37.3", 1, true) and read("out/fit/swing/x.png"):find("^\137PNG"))

-- With the wrong drag the residuals are no chance; from 4 there is a minimum where the phases meet at both ends.
code, text = fit("swing.lua --data motion.csv --by w2=4 g=0.1")
assert(code == 2 and text:find("the residuals follow each other", 1, true), text)
code, text = fit("swing.lua --data motion.csv --by w2=4 --starts 3 g=0.45")
assert(code == 0 and text:find("minimum 2: w2 = ", 1, true), text)
found, _, steps = value(text, "w2")
assert(math.abs(found - w2) <= steps and steps <= 1e-3 * w2, text)

-- The mass divides out.
code, text = fit("swing.lua --data motion.csv --by weight,w2 g=0.45")
assert(code == 2 and text:find("weight changes none of these measures", 1, true), text)
assert(math.abs(value(text, "w2") - w2) < 1e-3 * w2 and text:find("weight +1 +not known"), text)

-- ---- an interruption: what was run is not run again ----

_, text = fit("swing.lua --data motion.csv --by w2,g --out stopped --jobs 1",
  "sh -c '\"$@\" & p=$!; while [ $(cat stopped/runs.json 2>/dev/null | wc -l) -lt 6 ]; do sleep 0.01; done; kill -9 $p' sh")
assert(text ~= nil)
local kept = select(2, read("stopped/runs.json"):gsub('"key"', ""))
assert(kept >= 5, kept)
local _, again = fit("swing.lua --data motion.csv --by w2,g --out stopped")
local _, whole = fit("swing.lua --data motion.csv --by w2,g --out whole")
local rest, all = tonumber(again:match("(%d+) runs")), tonumber(whole:match("(%d+) runs"))
assert(rest <= all - 5, again .. whole)
assert(value(again, "w2") == value(whole, "w2") and not io.open(runs.folder .. "/stopped/runs.json"))

-- ---- what is refused ----

write("none.lua", "local scene = hooke.scene { duration = 1 }\nscene:particle { position = { 0, 0, 0 } }\nreturn scene\n")
write("name.csv", "t,xx\n1,2\n")
write("nan.csv", "t,x\n1,nan\n")
write("late.csv", "t,x\n1,2\n9,2\n")
write("sd.csv", "t,x,x_sd\n1,2,0\n")
write("one.csv", "t,x\n1,2\n")
write("time.csv", "x\n1\n")
write("gap.csv", "t,x\n1,\n")
write("cells.csv", "t,x\n1,2,3\n")
write("two.csv", "t,x,speed\n1,2,3\n")
write("some.csv", "t,x,x_sd\n1,2,1\n2,1,\n")
write("alone.csv", "t,speed_sd,x\n1,2,1\n")
refused("swing.lua --by w2", "no data: --data FILE.csv")
refused("swing.lua --by w2 --data nothing.csv", "cannot read nothing.csv: No such file or directory")
refused("swing.lua --data motion.csv", "nothing to find: --by NAME,NAME")
refused("swing.lua --data motion.csv --by w", "no parameter 'w'; did you mean 'w2'?")
refused("swing.lua --data motion.csv --by w2,w2", "w2 is there twice")
refused("swing.lua --data motion.csv --by w2 w2=3", "w2=3 and --by w2: leave one out")
refused("swing.lua --data motion.csv --by w2=500", "the start, 500, is not within 1 to 400")
refused("swing.lua --data motion.csv --by w2=5:4:3", "4 is not below 3")
refused("swing.lua --data motion.csv --by w2=x", "'x' is not a number")
refused("swing.lua --data motion.csv --by g --starts 3", "g has no bounds to spread starts over")
refused("swing.lua --data name.csv --by w2", "name.csv:1: the column 'xx' is no measure of the scene; ")
refused("swing.lua --data nan.csv --by w2", "nan.csv:2: x: 'nan' is not a finite number")
refused("swing.lua --data late.csv --by w2", "late.csv:3: t = 9 s is outside of the run, 0 to 3 s")
refused("swing.lua --data sd.csv --by w2", "sd.csv:2: x_sd: '0' is not positive")
refused("swing.lua --data one.csv --by w2,g", "1 numbers cannot determine 2 parameters")
refused("swing.lua --data time.csv --by w2", "time.csv:1: there is no column 't', the time in s")
refused("swing.lua --data gap.csv --by w2", "gap.csv: there is no number of a measure in it")
refused("swing.lua --data cells.csv --by w2", "cells.csv:2: 3 numbers, and 2 columns")
refused("swing.lua --data two.csv --by w2", "'x' has no column x_sd")
refused("swing.lua --data some.csv --by w2", "some numbers have a standard deviation and some have none (line 3)")
refused("swing.lua --data alone.csv --by w2", "'speed_sd' is there, 'speed' is not")
refused("none.lua --data motion.csv --by k", "the scene has no parameter 'k'; it has none: param(name, default)")
runs.close()
