-- hooke fit --shape: one file with where particles are, fitted as a whole, at rest and at a time: against least squares in closed form,
-- with their deviation; the table of --state as data; and what is refused.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "fit", "--quiet --no-diagrams")
local json = require("cjson")
local write, read, fit, refused = runs.write, runs.read, runs.run, runs.refused

local function parameter(scene, name)
  return json.decode((read(("out/fit/%s/fit.json"):format(scene)))).minima[1].parameters[name]
end

local function near(what, found, wanted, within)
  assert(math.abs(found - wanted) <= within, ("%s: %.15g, not %.15g"):format(what, found, wanted))
end

-- ---- at rest: a chain of springs hangs, z of particle i = -(i - 1) L - c g S_i, S_i the sum over its springs of the mass below ----

write("chain.lua", [[
local c = param("c", 0.01, "compliance of a spring, m/N", { min = 1e-4, max = 1 })
local scene = hooke.scene { duration = 2, fps = 20, integrator = "leapfrog" }
local top = scene:particle { position = { 0, 0, 0 }, mass = 1, group = "peg" }
local last, edges = top, {}
for i = 2, 6 do
  local p = scene:particle { position = { 0, 0, -0.2 * (i - 1) }, mass = 0.1 * i, group = i == 6 and "weight" or "links" }
  edges[#edges + 1] = { last, p }
  last = p
end
scene:pin { top }
scene:force("springs", { edges = edges, k = 1 / c, rest = 0.2 })
scene:force("gravity")
return scene
]])
local g, S, below = 9.81, { 0 }, { [7] = 0 }
for i = 6, 2, -1 do below[i] = below[i + 1] + 0.1 * i end
for i = 2, 6 do S[i] = S[i - 1] + below[i] end
local function depth(i, c) return -0.2 * (i - 1) - c * g * S[i] end

-- Measured with errors of some tenths of a millimetre, by the names of groups and by ids; the best c is that of linear regression.
local errors, lines, up, down = { 0, 3e-4, -2e-4, 1e-4, -4e-4, 2e-4 }, { "particle,x,z,sd", "peg,0,0,3e-4" }, 0, 0
for i = 2, 6 do
  lines[i + 1] = ("%s,%s,%.17g,3e-4"):format(i == 6 and "weight" or i, i == 3 and "" or "0", depth(i, 0.02) + errors[i])
  up, down = up - g * S[i] * errors[i], down + (g * S[i]) ^ 2
end
write("hangs.csv", "# where the links hang\n" .. table.concat(lines, "\n") .. "\n")
local code, text = fit("chain.lua --shape hangs.csv --at rest --by c")
assert(code == 0 and text:find("c from 11 numbers of a shape (at rest, ", 1, true), text)
local c = parameter("chain", "c")
near("compliance", c.value, 0.02 + up / down, 1e-6 * 0.02) -- of the fit; the scene is linear in c
near("its deviation", c.deviation * math.sqrt(down) / 3e-4, 1, 1e-4) -- differences of 1e-5 of equilibria to 1e-12 of the forces
assert(c.by_steps == 0, "no step is taken")
assert(read("out/fit/chain/fit.csv"):find("\n,z of 6,%-", 1), read("out/fit/chain/fit.csv"))
local described = json.decode((read("out/fit/chain/fit.json")))
assert(described.shape == "hangs.csv" and described.at == "rest" and described.data == json.null)

-- All particles without names, and the same by a script.
lines = { "z" }
for i = 1, 6 do lines[i + 1] = ("%.17g"):format(depth(i, 0.03)) end
write("all.csv", table.concat(lines, "\n") .. "\n")
code, text = fit("chain.lua --shape all.csv --at rest --by c")
assert(code == 0, text)
near("compliance", parameter("chain", "c").value, 0.03, 1e-6 * 0.03)
write("asks.lua", 'return hooke.fit { scene = "chain.lua", shape = "all.csv", at = "rest", by = { c = { 0.01, 1e-3, 0.1 } } }\n')
code, text = fit("asks.lua")
assert(code == 0 and text:find("\n  c +0%.03%s"), text)

-- The state that hooke rest writes is a shape.
local function hooke(words)
  return os.execute(("cd %s && %s/hooke %s >/dev/null 2>&1"):format(runs.folder, os.getenv("HK_BUILD"), words)) == true
end
assert(hooke("rest chain.lua c=0.05 --state rest.csv"))
code, text = fit("chain.lua --shape rest.csv --at rest --by c")
assert(code == 0, text)
near("compliance", parameter("chain", "c").value, 0.05, 1e-6 * 0.05)

-- ---- at a time: thrown balls, x = v t and z = -g t^2/2, which leapfrog takes exactly ----

write("throw.lua", [[
local v, fall = param("v", 1, "m/s"), param("fall", 8, "m/s^2", { min = 0 })
local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 0.01 }
scene:particle { position = { 0, 0, 0 }, velocity = { v, 0, 0 } }
scene:particle { position = { 1, 0, 2 }, velocity = { 2 * v, 0, 0 } }
scene:force("gravity", { g = { 0, 0, -fall } })
return scene
]])
write("thrown.csv", ("particle,x,y,z\n2,%.17g,0,%.17g\n1,%.17g,,%.17g\n"):format(1 + 2 * 3 * 0.4, 2 - 9.7 * 0.08, 3 * 0.4, -9.7 * 0.08))
code, text = fit("throw.lua --shape thrown.csv --at 0.4 --by v,fall")
assert(code == 0, text)
near("speed", parameter("throw", "v").value, 3, 1e-6 * 3)
near("fall", parameter("throw", "fall").value, 9.7, 1e-6 * 9.7)
assert(hooke("fit throw.lua --shape thrown.csv --at 0.4 --by v,fall --quiet --out drawn"))
assert(read("drawn/z.svg"):find("particle", 1, true) and read("drawn/page.html"):find("data:image/svg", 1, true), "diagrams over particles")

-- ---- what is refused ----

local function refuses(name, table_text, words, more)
  write(name .. ".csv", table_text)
  refused(("chain.lua --shape %s.csv --by c %s"):format(name, more or "--at rest"), words)
end
refuses("few", "z\n0\n-0.3\n", "few.csv: 2 lines of particles, and the scene has 6: give each a line, or name those that are there")
refuses("many", "z\n0\n1\n2\n3\n4\n5\n6\n", "many.csv: 7 lines of particles, and the scene has 6")
refuses("unknown", "particle,z\n1,0\n9,1\n", "unknown.csv:3: there is no particle 9: the scene has 6, 1 to 6")
refuses("name", "particle,z\nwieght,0\n", "name.csv:2: 'wieght' is neither the id of a particle nor a group of one; did you mean 'weight'?")
refuses("several", "particle,z\nlinks,0\n", "several.csv:2: the group 'links' has several particles: give their ids")
refuses("twice", "particle,z\n3,0\n4,0\n3,0\n", "twice.csv:4: particle 3 is there twice (line 2)")
refuses("column", "particle,z,w\n1,0,0\n", "column.csv:1: the column 'w' is none of a shape")
refuses("none", "particle,sd\n1,1\n", "none.csv:1: there is no column x, y or z, where particles are, m")
refuses("nan", "particle,z\n1,nan\n", "nan.csv:2: z: 'nan' is not a finite number")
refuses("sd", "particle,z,sd\n1,0,0\n", "sd.csv:2: sd: '0' is not positive")
refuses("cells", "particle,z\n1,0,0\n", "cells.csv:2: 3 numbers, and 2 columns")
refuses("gap", "particle,z\n1,\n", "gap.csv: there is no number of a place in it")
refuses("some", "particle,z,sd\n5,0,1\n6,0,\n", "some.csv: shape: some numbers have a standard deviation and some have none (line 3)")
refuses("late", "particle,z\n1,0\n", "--at: '9' is no time of the run, 0 to 2 s, nor end or rest", "--at 9")
refused("chain.lua --shape all.csv --data all.csv --by c", "--data and --shape: give one of them")
refused("chain.lua --by c", "no data: --data FILE.csv, or --shape FILE.csv")
refused("throw.lua --shape thrown.csv --at rest --by v", "from the start, v = 1: ") -- what falls has no equilibrium

runs.close()
