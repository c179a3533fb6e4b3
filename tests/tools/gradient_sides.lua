-- hooke gradient where a measure has a kink, jumps, or is at a parameter's bound: both one-sided derivatives against closed forms, in
-- words, JSON and page; and with what acts on the steps (impacts, cables, penalties) by whole runs.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "gradient")
local json = require("cjson")
local write, read, gradient = runs.write, runs.read, runs.run

-- The rows of gradient.json by the parameters' names, the exit code, the words and all of it.
local function found(scene, words)
  local code, text = gradient(("%s.lua %s"):format(scene, words))
  assert(code == 0 or code == 2, text)
  local all, rows = json.decode((read(("out/gradient/%s/gradient.json"):format(scene)))), {}
  for _, row in ipairs(all.parameters) do rows[row.name] = row end
  return rows, code, text, all
end

-- A side is off by no more than it says: by the extrapolation, and of steps half as much again as half of them change.
local function is(side, wanted, least)
  local off, said = math.abs(side.derivative - wanted), 1.5 * (tonumber(side.by_steps) or 0) + 2 * side.error + 1e-12
  assert(off <= said and said <= least, ("%.12g, not %.12g: said %.3g"):format(side.derivative, wanted, said))
end

-- ---- measures with a branch, of free flight: x = start, to rounding ----

write("branch.lua", [[
local start, k = param("start", 0, "m"), param("k", 0, "N/m", { min = 0 })
local scene = hooke.scene { duration = 1, fps = 20, integrator = "leapfrog", dt = 2e-3 }
local p = scene:particle { position = { start, 0.3, 0 }, mass = 2 }
scene:force("central", { strength = k, per = "particle" })
local function x(s) return s:position(p)[1] end
scene:measure("size", function(s) return math.abs(x(s)) end)
scene:measure("clamp", function(s) return math.max(0.5, math.min(x(s) + 0.5, 2)) + 3 * x(s) end)
scene:measure("count", function(s) return x(s) > 0 and 1 or 0 end)
scene:measure("square", function(s) return x(s) ^ 2 end)
scene:measure("y", function(s) return s:position(p)[2] end)
return scene
]])
-- Differences of about 1e-5 m have rounding of about 1e-11; of them more are taken.
for _, way in ipairs { "forwards", "backwards" } do
  for measure, wanted in pairs { size = { -1, 1 }, clamp = { 3, 4 } } do
    local rows, code, text, all = found("branch", ("--of %s --by start --way %s"):format(measure, way))
    assert(code == 0 and all.sure, text)
    assert(rows.start.kind == "one-sided" and rows.start.derivative == json.null, text)
    is(rows.start.from_below, wanted[1], 1e-9)
    is(rows.start.from_above, wanted[2], 1e-9)
    assert(text:find(("\n  start below 0 +%g "):format(wanted[1])) and text:find(("\n  start above 0 +%g "):format(wanted[2])), text)
    assert(text:find("'" .. measure .. "' has a kink at this value", 1, true), text)
    local page = read("out/gradient/branch/page.html")
    assert(page:find("one-sided derivative", 1, true) and page:find("start above 0", 1, true), "the page has both sides")
  end
end
local rows, code, text, all
rows, code, text = found("branch", "--of clamp --by start=0.7") -- beside the kink it is smooth
assert(code == 0 and rows.start.kind == "two-sided" and math.abs(rows.start.derivative - 4) < 1e-8, text)
rows, code, text = found("branch", "--of square --by start") -- the bottom of a parabola is none
assert(code == 0 and rows.start.kind == "two-sided" and math.abs(rows.start.derivative) < 1e-12, text)
rows, code, text, all = found("branch", "--of count --by start")
assert(code == 2 and rows.start.kind == "none" and rows.start.derivative == json.null and not all.sure, text)
assert(text:find("jumps just above this value, from 0 to 1, and has no derivative", 1, true), text)

-- ---- at a bound: y = y0 cos(sqrt(k/m) t), by k at 0 -y0 t^2/(2 m) ----

rows, code, text, all = found("branch", "--of y --by k,start")
assert(code == 0 and rows.k.kind == "one-sided" and rows.k.from_below == json.null, text)
is(rows.k.from_above, -0.3 / 4, 1e-5)
assert(rows.start.kind == "two-sided" and math.abs(rows.start.derivative) < 1e-9, text)
assert(text:find("k below 0 +none: its bound is there") and all.whole_runs:find("k = 0 is at its bound", 1, true), text)

-- ---- a rope that is just slack: it stays where it is, or swings to its middle and flies on, 1 - d w (t - pi/(2 w)) ----

write("rope.lua", [[
local far = param("far", 1, "where it begins, m")
local scene = hooke.scene { duration = 0.3, integrator = "rk4", dt = 1e-3 }
local p = scene:particle { position = { far, 0, 0 } }
local o = scene:particle { position = { 0, 0, 0 } }
scene:pin { o }
scene:force("ropes", { edges = { { p, o } }, k = 100, rest = 1 })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
rows, code, text = found("rope", "--of x --by far")
assert(code == 0 and rows.far.kind == "one-sided", text)
is(rows.far.from_below, 1, 1e-9)
is(rows.far.from_above, -(3 - math.pi / 2), 1e-4) -- rk4 goes over the end of the pull at a time of its own: h^2

-- ---- a ball that just touches the floor at the end, z = 1 - v t, or e (v t - 1) after it; beyond it by v and e ----

write("ball.lua", [[
local v, e = param("v", 1, "m/s"), param("e", 0.5, "restitution", { min = 0, max = 1 })
local scene = hooke.scene { duration = 1, integrator = "leapfrog", dt = 1e-2 }
local p = scene:particle { position = { 0, 0, 1 }, velocity = { 0, 0, -v } }
scene:corrector("obstacle", { restitution = e })
scene:measure("z", function(s) return s:position(p)[3] end)
scene:measure("speed", function(s) return s:velocity(p)[3] end)
return scene
]])
rows, code, text, all = found("ball", "--of z --by v")
assert(code == 0 and rows.v.kind == "one-sided" and all.whole_runs:find("corrector 'obstacle' acts on the steps", 1, true), text)
is(rows.v.from_below, -1, 1e-9)
is(rows.v.from_above, 0.5, 1e-9)
rows, code, text = found("ball", "--of z --by v=1.5,e")
assert(code == 0 and rows.v.kind == "two-sided" and math.abs(rows.v.derivative - 0.5) < 1e-9, text)
assert(math.abs(rows.e.derivative - 0.5) < 1e-9, text) -- (v t - 1)
rows, code, text = found("ball", "--of z --by e=1 v=1.5")
assert(code == 0 and rows.e.from_above == json.null, text)
is(rows.e.from_below, 0.5, 1e-9)
rows, code, text = found("ball", "--of speed --by v") -- -v, or e v after it
assert(code == 2 and rows.v.kind == "none" and text:find("and has no derivative", 1, true), text)

-- ---- a cable that is just taut at the start, x = 1 + min(v, 0) t, and one that becomes taut on the way, at rest after it ----

write("cable.lua", [[
local v, start = param("v", 0, "m/s"), param("start", 1, "m")
local scene = hooke.scene { duration = 1, integrator = "leapfrog", dt = 1e-2 }
local p, o = scene:particle { position = { start, 0, 0 }, velocity = { v, 0, 0 } }, scene:particle { position = { 0, 0, 0 } }
scene:pin { o }
scene:constraint("cables", { edges = { { p, o } }, length = 1 })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
rows, code, text, all = found("cable", "--of x --by v")
assert(code == 0 and rows.v.kind == "one-sided" and all.whole_runs:find("constraint 'cables' acts on one side only", 1, true), text)
is(rows.v.from_below, 1, 1e-9)
is(rows.v.from_above, 0, 1e-9)
rows, code, text = found("cable", "--of x --by v=0.3,start=0.5") -- taut after the end
assert(code == 0 and math.abs(rows.v.derivative - 1) < 1e-9 and math.abs(rows.start.derivative - 1) < 1e-9, text)
rows, code, text = found("cable", "--of x --by v=0.5 start=0.5") -- just at the end
assert(code == 0 and rows.v.kind == "one-sided", text)
is(rows.v.from_below, 1, 1e-9)
is(rows.v.from_above, 0, 1e-9)

-- ---- a soft floor: half an oscillation, and the landing lies on an end of a step, which is no kink of the scene ----

write("soft.lua", [[
local v = param("v", 1, "m/s")
local scene = hooke.scene { duration = 1.2, integrator = "leapfrog", dt = 1e-3 }
local p = scene:particle { position = { 0, 0, 1 }, velocity = { 0, 0, -v } }
scene:force("penalty", { k = 100 })
scene:measure("z", function(s) return s:position(p)[3] end)
return scene
]])
-- z = -v/w sin(w (t - 1/v)); by v -sin(u)/w - cos(u)/v, u = 2 at v = 1
rows, code, text = found("soft", "--of z --by v")
assert(code == 2 and text:find("the kink is one of the steps", 1, true), text)
local slope = -math.sin(2) / 10 - math.cos(2)
assert((rows.v.from_below.derivative - slope) * (rows.v.from_above.derivative - slope) < 0, text) -- between both

runs.close()
