-- hooke gradient as a user meets it: derivatives that are known in closed form, forwards and backwards, a kink that is said,
-- and what is refused in one sentence.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "gradient")
local write, read, gradient, refused = runs.write, runs.read, runs.run, runs.refused

-- The derivative, the part of the steps in it and that of rounding.
local function derivative(text, name)
  local found, steps, rounding = text:match("\n  " .. name .. " +%S+ +(%S+) +(%S+) +(%S+)")
  return assert(tonumber(found), text), tonumber(steps), tonumber(rounding)
end

-- ---- an oscillator, x = A cos(w t + f): stiffness, mass, and start in three ways ----

write("swing.lua", [[
local k = param("k", 40, "stiffness, N/m", { min = 0 })
local m = param("m", 2, "mass, kg", { min = 0.1 })
local start = param("start", 0.1, "m")
local speed = param("speed", 0.2, "m/s")
local factor = param("factor", 3, "of the measure")
local scene = hooke.scene { duration = 1.5, fps = 20, integrator = "leapfrog", dt = 1e-3 }
local p = scene:particle { position = { start, 0, 0 }, velocity = { speed, 0, 0 }, mass = m }
scene:force("central", { strength = k, per = "particle" })
scene:measure("x", function(s) return s:position(p)[1] end)
scene:measure("scaled", function(s) return factor * s:position(p)[1] end)
scene:measure("size", function(s) return math.abs(s:position(p)[1]) end)
local calls = 0
scene:measure("calls", function() calls = calls + 1 return calls end)
return scene
]])
local w, t = math.sqrt(40 / 2), 1.5
local x = 0.1 * math.cos(w * t) + 0.2 / w * math.sin(w * t)
local by_w = -0.1 * t * math.sin(w * t) + 0.2 * (t * math.cos(w * t) / w - math.sin(w * t) / w ^ 2)
local exact = { k = by_w * w / (2 * 40), m = -by_w * w / (2 * 2), start = math.cos(w * t), speed = math.sin(w * t) / w }

local function check(text, factor, names)
  for _, name in ipairs(names) do
    local found, steps, rounding = derivative(text, name)
    local slope = factor * exact[name]
    assert(math.abs(found - slope) <= 1.05 * steps + rounding, ("%s: %g\n%s"):format(name, slope, text))
    assert(steps < 1e-3 * math.abs(found) and rounding < 1e-8 * math.abs(found), text)
  end
end

local code, text = gradient("swing.lua --of x --by k,m,start,speed,factor")
assert(code == 0, text)
check(text, 1, { "k", "m", "start", "speed" })
assert(derivative(text, "factor") == 0, text)
assert(text:find("leapfrog, 1500 steps of 0.001 s, forwards", 1, true), text)
assert(read("out/gradient/swing/gradient.json"):find('"sure":true', 1, true))
assert(read("out/gradient/swing/page.html"):find('<img src="data:image/svg', 1, true), "the page has its diagram")
assert(read("out/gradient/swing/gradient.csv"):find("^t,x,by_k,by_m,by_start,by_speed,by_factor\n0,0.1"))
assert(select(2, read("out/gradient/swing/gradient.csv"):gsub("\n", "\n")) == 32) -- a frame at every 0.05 s

-- The same of an implicit method, and of one that solves one linear system a step and may choose shorter ones.
for _, method in ipairs { "implicit_midpoint", "linear_bdf2 --dt 5e-4" } do
  for _, way in ipairs { "forwards", "backwards" } do
    code, text = gradient(("swing.lua --of x --by k,m,start,speed --integrator %s --way %s"):format(method, way))
    assert(code == 0, text)
    check(text, 1, { "k", "m", "start", "speed" })
  end
end
assert(text:find("(linear_bdf2, 3000 steps of at most 0.0005 s, backwards", 1, true), text)

-- Backwards, and by what the measure itself makes of a parameter.
code, text = gradient("swing.lua --of scaled --by k,start,factor --way backwards")
assert(code == 0 and text:find("backwards", 1, true), text)
check(text, 3, { "k", "start" })
local found, steps = derivative(text, "factor")
assert(math.abs(found - x) <= 1.05 * steps + 1e-12, text)

-- ---- pins that move and slide: whole runs beside agree, or the exit code is 2 ----

write("pins.lua", [[
local k, far = param("k", 40, "N/m"), param("far", 0.1, "m")
local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 4e-3 }
local a = scene:particle { position = { 0, 0, 0 } }
local b = scene:particle { position = { 1, 0, 0.1 } }
local c = scene:particle { position = { 1.5, 0, 0.5 } }
local d = scene:particle { position = { 2, 1, 0.5 } }
scene:pin({ a }, { path = function(t) return 0.2 * math.sin(3 * t), 0, far * math.sin(2 * t) end })
scene:pin({ c }, { axes = { math.cos(0.3), 0, math.sin(0.3) } })
scene:pin({ d }, { normal = { 0, 0, 1 } })
scene:force("springs", { edges = { { a, b }, { b, c }, { c, d } }, k = k, rest = 0.7, damping = 0.3 })
scene:measure("x", function(s) return s:position(b)[3] + s:position(c)[1] + s:velocity(d)[2] end)
return scene
]])
code, text = gradient("pins.lua --of x --by k --way backwards")
assert(code == 0, text)
refused("pins.lua --of x --by far", "a parameter changes the path of a pin, which is not differentiated")

-- ---- constraints: whole runs beside agree; a rigid body on a string of bars ----

write("bodies.lua", [[
local rho, g, spin = param("rho", 700, "kg/m^3"), param("g", 9.81, "m/s^2"), param("spin", 2, "rad/s")
local L = param("L", 0.5, "of the string, m")
local scene = hooke.scene { duration = 0.4, fps = 20, integrator = "leapfrog", dt = 1e-3 }
local function box(x, density, w)
  return scene:rigid { shape = "box", size = { 0.4, 0.3, 0.2 }, density = density, position = { x, 0, 0 }, spin = w }
end
local a, b = box(0.2, rho, { 1, spin, 0.5 }), box(0.7, 500)
scene:joint { kind = "ball", a = a, b = b, at = { 0.45, 0, 0 } }
local string = scene:strand { n = 3, from = { 0, 0, L }, to = { 0, 0, 0 }, mass = 0.5 }
scene:pin { string:at(1) }
scene:joint { kind = "ball", a = a, b = string:at(3), at = { 0, 0, 0 } }
scene:force("gravity", { g = { 0, 0, -g } })
scene:constraint("bars", { edges = string:structural() })
scene:measure("x", function(s) return b:position(s)[1] + 0.2 * b:velocity(s)[3] + a:spin(s)[1] end)
return scene
]])
write("slider.lua", [[
local rho, g, spin = param("rho", 700, "kg/m^3"), param("g", 9.81, "m/s^2"), param("spin", 2, "rad/s")
local L = param("L", 0.4, "of the spring, m")
local scene = hooke.scene { duration = 0.5, fps = 20, integrator = "leapfrog", dt = 1e-3 }
local function box(x, density, w)
  return scene:rigid { shape = "box", size = { 0.4, 0.3, 0.2 }, density = density, position = { x, 0, 0 }, spin = w }
end
local a, b, c = box(0, rho, { 0, 0, spin }), box(0.5, 500), box(1, 600)
scene:joint { kind = "hinge", a = a, at = { 0, 0, 0 }, axis = { 0, 0, 1 } }
scene:joint { kind = "slider", a = a, b = b, at = { 0.25, 0, 0 }, axis = { 1, 0, 0 } }
scene:joint { kind = "hinge", a = b, b = c, at = { 0.75, 0, 0 }, axis = { 0, 1, 0 } }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = { { a:point { 0.1, 0, 0 }, b:point { 0.1, 0, 0 } } }, k = 60, rest = L, damping = 2 })
scene:measure("x", function(s) return c:position(s)[1] + 0.2 * c:velocity(s)[3] + a:spin(s)[3] end)
return scene
]])
for k = 1, 4 do
  local name, way = k < 3 and "bodies" or "slider", k % 2 == 1 and "forwards" or "backwards"
  code, text = gradient(name .. ".lua --of x --by rho,g,spin,L --way " .. way)
  assert(code == 0, text)
  local list = read("out/gradient/" .. name .. "/gradient.json"):match('"parameters":(%b[])')
  for row in list:gmatch("%b{}") do
    local slope, whole = tonumber(row:match('"derivative":([^,}]+)')), tonumber(row:match('"by_runs":([^,}]+)'))
    assert(math.abs(slope - whole) < 1e-6 * math.abs(slope), row) -- differences of 1e-5 of a parameter
  end
end

-- A bead on a rod that a pin turns at 2 rad/s: r = r_0 cosh 2t + v_0/2 sinh 2t.
write("bead.lua", [[
local r, v = param("r", 0.1, "m"), param("v", 0.05, "m/s")
local scene = hooke.scene { duration = 1, fps = 20, dt = 2e-3, integrator = "leapfrog" }
local ends = {}
for k, p in ipairs { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0.5, 1 } } do ends[k] = scene:particle { position = p } end
local bead = scene:particle { position = { r, 0, 0 }, velocity = { v, 2 * r, 0 }, mass = 3 }
scene:pin { ends[1], ends[2] }
scene:pin({ ends[3] }, { path = function(s) return -0.5 * math.sin(2 * s), 0.5 * math.cos(2 * s) - 0.5, 0 end })
scene:constraint("guides", { points = { { ends[1], bead, ends[2], ends[3] } } })
scene:measure("x", function(s) return math.sqrt(s:position(bead)[1] ^ 2 + s:position(bead)[2] ^ 2) end)
return scene
]])
for _, way in ipairs { "forwards", "backwards" } do
  code, text = gradient("bead.lua --of x --by r,v --way " .. way)
  assert(code == 0, text)
  for name, slope in pairs { r = (math.exp(2) + math.exp(-2)) / 2, v = (math.exp(2) - math.exp(-2)) / 4 } do
    local by, by_steps, by_rounding = derivative(text, name)
    assert(math.abs(by - slope) <= 1.05 * by_steps + by_rounding and by_steps < 1e-4, text)
  end
end
refused("bodies.lua --of x --by g --integrator rk4", "integrator 'rk4' brings the state back onto constraints by an iteration")

write("bowl.lua", [[
local g = param("g", 9.81, "m/s^2")
local scene = hooke.scene { duration = 0.1, integrator = "leapfrog", dt = 1e-2 }
local p = scene:particle { position = { 1, 0, 0 } }
scene:constraint("surface", { particles = { p } })
scene:force("gravity", { g = { 0, 0, -g } })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
refused("bowl.lua --of x --by g", "constraint 'surface' states no second derivatives of its equations")

-- ---- a rope that goes slack, where the derivative is one-sided ----

write("rope.lua", [[
local far = param("far", 1, "where it begins, m")
local scene = hooke.scene { duration = 0.3, integrator = "rk4", dt = 1e-2 }
local p = scene:particle { position = { far, 0, 0 } }
local o = scene:particle { position = { 0, 0, 0 } }
scene:pin { o }
scene:force("ropes", { edges = { { p, o } }, k = 100, rest = 1 })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
code, text = gradient("rope.lua --of x --by far")
assert(code == 0 and text:find("  far +1 +one%-sided") and text:find("\n  far below 1 +1 "), text) -- more in gradient_sides.lua

-- ---- a parameter that changes nothing: what whole runs differ by is rounding, and no kink ----

write("pendulum.lua", [[
local m, L = param("m", 1.4, "kg"), param("L", 0.9, "m")
local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 1e-3 }
local o, p = scene:particle { position = { 0, 0, 0 } }, scene:particle { position = { L * math.sin(1.1), 0, -L * math.cos(1.1) }, mass = m }
scene:pin { o }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:constraint("bars", { edges = { { o, p } } })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
for _, way in ipairs { "forwards", "backwards" } do
  code, text = gradient("pendulum.lua --of x --by m,L --way " .. way)
  assert(code == 0, text)
  assert(math.abs(derivative(text, "m")) < 1e-10, text) -- eps/1e-5
end

-- ---- a measure that jumps, a parameter that does nothing, one that sets the duration or the steps ----

write("free.lua", [[
local F, unused, T = param("F", 2, "N"), param("unused", 5), param("T", 1, "s")
local h = param("h", 0.01, "s")
local scene = hooke.scene { duration = T, fps = 10, integrator = "leapfrog", dt = h }
local p = scene:particle { position = { 3, 0, 0 }, mass = 2 }
scene:force("gravity", { g = { F / 2, 0, 0 } })
scene:measure("x", function(s) return s:position(p)[1] end) -- 3 + F T^2/4
scene:measure("branch", function(s) return s:position(p)[1] > 3.5 and 7 or 3.5 end)
return scene
]])
code, text = gradient("free.lua --of branch --by F")
assert(code == 2 and text:find("not sure: F: the measure jumps just below this value, from 7 to 3.5, and has no derivative", 1, true), text)
code, text = gradient("free.lua --of x --by F,unused")
assert(code == 0 and text:find("unused changes nothing of 'x', at no frame", 1, true), text)
assert(not text:find("F changes", 1, true), text)
local described = read("out/gradient/free/gradient.json")
assert(described:find('"doubts":[]', 1, true) and described:find('"remarks":["unused', 1, true), described)
code, text = gradient("free.lua --of x --by T")
assert(code == 2 and text:find("T: a run with a little less or more of it ends earlier: run: to: 1 s is after", 1, true), text)
code, text = gradient("free.lua --of x --by h")
assert(code == 0 or text:find("h: whole runs beside give .* it changes the steps themselves"), text)

-- 1e-4 s are one step: the difference of two numbers near 3 is eps/2 3/1.5e-5 off, which is said.
code, text = gradient("free.lua --of x --by F --at 1e-4")
local by, _, off = derivative(text, "F")
assert(code == 0 and math.abs(by - 2.5e-9) <= off and off < 1e-10, text)

-- When a run passes a kink: where the force ends at x = 1, at t = 0.1 s.
write("edge.lua", [[
local far = param("far", 0.9, "m")
local scene = hooke.scene { duration = 0.3, fps = 60, integrator = "rk4", dt = 1e-2 }
local p = scene:particle { position = { far, 0, 0 }, velocity = { 1, 0, 0 } }
scene:force("field", { f = function(_, x) return x > 1 and -50 or 0, 0, 0 end })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
code, text = gradient("edge.lua --of x --by far")
assert(code == 2 and text:find("lies between, by t = 0.1[01]", 1), text)

-- ---- by a function of time: x = integral of (1 - t) u(t) dt, of hats as wide as knots are apart ----

write("pushed.lua", [[
local scene = hooke.scene { duration = 1, fps = 10, integrator = "leapfrog", dt = 0.005 }
local p = scene:particle {}
local u = scene:control("push", { knots = 6 })
scene:force("gravity", { g = function(t) return u(t), 0, 0 end })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
code, text = gradient("pushed.lua --of x --by push")
assert(code == 0 and math.abs(derivative(text:gsub("6 knots", "6"), "push") - 0.5) < 1e-12, text)
local knots, d = require("cjson").decode((read("out/gradient/pushed/gradient.json"))).parameters[1].knots, 0.2
assert(#knots == 6)
for k, knot in ipairs(knots) do
  local wanted = k == 1 and d / 2 - d * d / 6 or k == 6 and d * d / 6 or d * (1 - knot.t)
  assert(math.abs(knot.derivative - wanted) < 0.005 ^ 2, ("t = %g s: %.9g"):format(knot.t, knot.derivative)) -- h^2, the trapezium rule
end
assert(read("out/gradient/pushed/gradient.png"):find("^\137PNG"))
-- So pushed it comes to rest, and its end has neither extent nor speed, to which the steps taken again would be compared.
code, text = gradient("pushed.lua --of x --by push push='1: 6 3.6 1.2 -1.2 -3.6 -6'")
assert(code == 0 and math.abs(derivative(text:gsub("6 knots", "6"), "push") - 0.5) < 1e-9, text)
refused("pushed.lua --of x --by push=3", "push is a function of time: its values are given by push=")
refused("pushed.lua --of x --by push --way forwards", "push is a function of time, whose values at knots are taken backwards")

-- ---- a run that explodes has no derivative worth the name ----

write("explode.lua", [[
local k, far = param("k", 4e4, "N/m"), param("far", 1.1, "m")
local scene = hooke.scene { duration = 1, fps = 100, integrator = "leapfrog", dt = 1e-2 }
local o, p = scene:particle { position = { 0, 0, 0 } }, scene:particle { position = { far, 0, 0 } }
scene:pin { o }
scene:force("springs", { edges = { { o, p } }, k = k, rest = 1 })
scene:measure("x", function(s) return s:position(p)[1] end)
return scene
]])
refused("explode.lua --of x --by k=1e5", "the run explodes: its energy grew by")
refused("explode.lua --of x --by k=1e5 --at 0.5", "the run explodes: its energy grew by")

-- ---- what is refused ----

refused("swing.lua --of y --by k", "the scene has no measure 'y'; ")
refused("swing.lua --of calls --by k", "the measure 'calls': it remembers its calls")
refused("swing.lua --of x --by k --integrator dopri5", "choose one that does, with --integrator; there are backward_euler, bdf2, euler")

write("more.lua", [[
local count = param("count", 2.5, "of particles")
local scene = hooke.scene { duration = 0.1, integrator = "rk4", dt = 1e-2 }
for k = 1, count > 2.5 and 3 or 2 do scene:particle { position = { k, 0, 0 } } end
scene:measure("x", function(s) return s:position(1)[1] end)
return scene
]])
refused("more.lua --of x --by count", "count: it changes the number or the order of the particles")

runs.close()
