-- Scripts that describe a fit or an optimisation, hooke.fit{} and hooke.optimise{}: their answers are those of the command line, the
-- function `found` gets the result in the sandbox, and what a description gets wrong is one sentence.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "fit", "--quiet")
local write, read, hooke = runs.write, runs.read, runs.hooke

local function says(command, wanted, code)
  local exit, text = hooke(command)
  assert(exit == (code or 0) and text:find(wanted, 1, true), ("%s: exit %d: %s"):format(command, exit, text))
  return text
end

local function refused(tool, fields, wanted)
  write("bad.lua", ("return hooke.%s { %s }\n"):format(tool, fields))
  assert(not says(tool .. " bad.lua", wanted, 1):find("\n.")) -- one sentence
end

write("push.lua", [[
local f = param("f", 0)
local scene = hooke.scene { duration = 2, fps = 5, integrator = "rk4", dt = 0.05 }
local push = scene:control("push", { knots = param("knots", 11) })
local p = scene:particle { position = { 0, 0, 0 }, mass = param("mass", 2) }
scene:force("field", { f = function(t) return push(t) + f, 0, 0 end })
scene:measure("x", function(s) return s:position(p)[1] end)
scene:measure("v", function(s) return s:velocity(p)[1] end)
return scene
]])

-- ---- an optimisation: rest to rest costs 12 m^2 d^2/T^3 = 6 ----

write("rest.lua", [[
return hooke.optimise {
  scene = "push.lua", goal = { x = 1, v = 0 }, params = { knots = 5 },
  found = function(optimum)
    local best = optimum.best
    local scene = hooke.scene { duration = 1, fps = 10, integrator = "rk4" } -- a scene of its own
    local p = scene:particle { position = { 0, 0, 0 }, velocity = { best.controls[1].values[1], 0, 0 } }
    return { cost = best.cost, knots = #best.controls[1].values, far = scene:run():state():position(p)[1] }
  end,
}
]])
local text = says("optimise rest.lua", "\n  knots            5\n")
assert(math.abs(tonumber(text:match("\n  cost +(%S+)")) - 6) < 1e-8 and math.abs(tonumber(text:match("\n  far +(%S+)")) - 3) < 1e-8, text)
assert(read("out/optimise/rest/optimum.json"):find('"answer":{', 1, true))

-- What the command line says is in the place of it.
text = says("optimise rest.lua --goal x=2,v=0 knots=3 --json", '"knots":3')
assert(math.abs(tonumber(text:match('"answer":.-"cost":([%d.e+-]+)')) - 24) < 1e-8, text)

-- ---- a fit: x = f t^2/(2 m) ----

write("push.csv", "t,x\n0.5,0.1251\n1,0.4999\n1.5,1.1249\n2,2.0001\n")
write("force.lua", [[
return hooke.fit { scene = "push.lua", data = "push.csv", by = { f = { 1, -5, 5 } },
  found = function(fit) return (fit.best.parameters.f.value - 2) / fit.best.parameters.f.deviation end }
]])
text = says("fit force.lua", "f from 4 numbers of x")
local deviations = tonumber(text:match("\n  (%S+)\nwrote"))
assert(deviations and math.abs(deviations) < 3, text)
-- The least squares of f = sum x t^2/2m / sum (t^2/2m)^2 with their deviation, by hand.
local a, b, rest = 0, 0, 0
local data = { { 0.5, 0.1251 }, { 1, 0.4999 }, { 1.5, 1.1249 }, { 2, 2.0001 } }
for _, row in ipairs(data) do
  a, b = a + row[2] * row[1] ^ 2 / 4, b + (row[1] ^ 2 / 4) ^ 2
end
for _, row in ipairs(data) do rest = rest + (row[2] - a / b * row[1] ^ 2 / 4) ^ 2 end
local exact = (a / b - 2) / math.sqrt(rest / 3 / b)
assert(math.abs(deviations - exact) < 1e-3 * math.abs(exact), ("%.9g\n%s"):format(exact, text))

-- ---- what is refused ----

refused("optimise", 'scene = "push.lua", gaol = {}', "bad.lua: hooke.optimise{} has no field 'gaol'; did you mean 'goal'?")
refused("optimise", "goal = { x = 1 }", 'bad.lua: hooke.optimise{} names no scene: scene = "FILE.lua"')
refused("optimise", 'scene = "push.lua", goal = { x = "a" }', "bad.lua: goal: expected { NAME = NUMBER }")
refused("optimise", 'scene = "push.lua", trust = true', "hooke.optimise{} has no field 'trust'")
refused("optimise", 'scene = "push.lua", params = { ["--trust"] = 1 }', "params: expected { name = value }")
refused("optimise", 'scene = "push.lua", found = 3', "bad.lua: found: expected a function")
refused("optimise", 'scene = "push.lua", goal = { x = 1 }, most = 0', "--most: '0' is not a whole number above 0")
refused("fit", 'scene = "push.lua", data = "/etc/passwd", by = "f"', "bad.lua: data: it is outside the folders")
refused("fit", 'scene = "push.lua", data = "push.csv", by = { f = { "a" } }', "--by: f: 'a' is not a number")
write("bad.lua", 'return hooke.fit { scene = "push.lua", data = "push.csv", by = "f", found = function(fit) return fit.no.thing end }')
says("fit bad.lua", "bad.lua:1: attempt to index a nil value (field 'no')", 1)
write("bad.lua", 'return hooke.fit { scene = "push.lua", data = "push.csv", by = "f", found = function() end }')
says("fit bad.lua", "the answer of found: a nil cannot be a part of it", 1)

runs.close()
