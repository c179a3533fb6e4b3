-- hooke optimise as a user meets it: optima in closed form and by multipliers, goals that contradict each other, and what is
-- refused in one sentence.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "optimise", "--quiet")
local write, read, hooke, refused = runs.write, runs.read, runs.hooke, runs.refused

local function optimum(arguments)
  local code, text = hooke("optimise " .. arguments)
  assert(code == 0, text)
  local cost, iterations = text:match("optimum 1: (%S+) after (%d+) iterations")
  return tonumber(cost), tonumber(iterations), text
end

local function cost_of(arguments)
  local cost, _, text = optimum(arguments)
  return cost, text
end

-- ---- a particle of 2 kg on a spring of k N/m, pushed: linear, so that the first step is the optimum ----

write("push.lua", [[
local k, knots = param("k", 0, "N/m"), param("knots", 11)
local scene = hooke.scene { duration = 2, fps = 5, integrator = "rk4", dt = 0.025 }
local push = scene:control("push", { knots = knots, duration = 2 })
local p = scene:particle { position = { 0, 0, 0 }, mass = 2 }
scene:force("field", { f = function(t) return push(t), 0, 0 end })
if k > 0 then scene:force("central", { strength = k, per = "particle" }) end
scene:measure("x", function(s) return s:position(p)[1] end)
scene:measure("v", function(s) return s:velocity(p)[1] end)
scene:measure("twice", function(s) return 2 * s:position(p)[1] end)
scene:measure("other", function(s) return s:position(p)[2] end)
return scene
]])

-- Rest to rest by d in T: 12 m^2 d^2/T^3 by a force that is linear in time, as the controls are (Witkin and Kass 1988).
local cost, iterations, text = optimum("push.lua --goal x=1,v=0")
assert(math.abs(cost - 6) < 1e-11 and iterations == 1, text)
local page = read("out/optimise/push/page.html")
assert(page:find('<img src="data:image/svg', 1, true) and page:find("optimum 1", 1, true), "the page has the controls and the goals")
local described = read("out/optimise/push/optimum.json")
for _, part in ipairs { '"sure":true', '"doubts":[]', '"answer":null', '"levels":[]', '"error_by_knots":null' } do
  assert(described:find(part, 1, true), described)
end

-- A lone particle that comes to rest: at its end the scene has no extent and no speed, to which the steps taken again would be compared.
write("lone.lua", [[
local which = param("which", "rest")
local scene = hooke.scene { duration = 1, fps = 20, integrator = "leapfrog", dt = 1e-2 }
local p = scene:particle { mass = 2 }
local u = scene:control("push", { knots = 11, help = "m/s^2", min = which == "bounds" and -1 or nil, max = which == "bounds" and 1 or nil })
scene:force("gravity", { g = function(t) return u(t), 0, 0 end })
scene:measure("x", function(s) return s:position(p)[1] end)
scene:measure("v", function(s) return s:velocity(p)[1] end)
if which == "endless" then scene:cost(function(s) return -s:position(p)[1] end) end
return scene
]])
local lone
lone, iterations, text = optimum("lone.lua --goal x=1,v=0")
assert(math.abs(lone / 12 - 1) < 5e-4 and iterations == 1, text) -- 12 d^2/T^3; leapfrog's end is off by h^2 (4e-4 of it)
assert(read("out/optimise/lone/controls.gp"):find("push (m/s^2)", 1, true))
refused("lone.lua --goal x=1,v=0 which=bounds", "the goal 'x' = 1 at 1 s cannot be met within the bounds of the controls")
refused("lone.lua --goal x=1 which=endless", "the cost has no lower bound: it falls as far as controls are let")
text = select(3, optimum("lone.lua --goal x=1,v=0 --at 0.5"))
assert(text:find("the squares of the controls over all of their 1 s, to t = 0.5 s", 1, true), text)

local values = read("out/optimise/push/1-push.txt")
local first, last = values:match("^2: (%S+) .* (%S+)\n$")
assert(math.abs(tonumber(first) - 3) < 1e-10 and math.abs(tonumber(last) + 3) < 1e-10, values)
assert(select(2, read("out/optimise/push/1.csv"):gsub("\n", "\n")) == 12)

-- What was found runs as it is, by any method: v and x after half of the time are 3 d/(2 T) and d/2.
local code
code, text = hooke("run push.lua --integrator dop853 --until 1 --json --no-output push=\"$(cat out/optimise/push/1-push.txt)\"")
assert(code == 0 and math.abs(tonumber(text:match('"x": *([%d.eE+-]+)')) - 0.5) < 1e-6, text)

-- On a spring: d^T W^-1 d with the Gramian W, the integral of b b^T, b = (sin ws / (m w), cos ws / m). Functions that are
-- linear between knots 1/20 s apart cost more, by a part of about (w/20)^4/720 = 7e-7.
local m, k, t = 2, 18, 2
local w = math.sqrt(k / m)
local a = (t / 2 - math.sin(2 * w * t) / (4 * w)) / (m * w) ^ 2
local b = math.sin(w * t) ^ 2 / (2 * w) / (m * m * w)
local c = (t / 2 + math.sin(2 * w * t) / (4 * w)) / m ^ 2
local exact = c / (a * c - b * b) -- d = (1, 0)
cost, iterations, text = optimum("push.lua --goal x=1,v=0 k=18 knots=41")
assert(cost > exact * (1 - 1e-6) and cost < exact * (1 + 1e-5) and iterations <= 2, ("%.9g\n%s"):format(exact, text))

-- With knots half as far apart the optimum falls by what the closed form says, and its error by the knots is known.
cost, text = cost_of("push.lua --goal x=1,v=0 k=18 knots=11 --refine 2")
local bound = tonumber(text:match("its error by the knots is (%S+) at most"))
assert(cost > exact and cost - exact < bound and bound < 1e-3 * exact and text:find("41 knots: ", 1, true), text)

-- Goals that one control cannot all meet, and one that nothing changes.
refused("push.lua --goal x=1,twice=3", "the goal 'twice' = 3 at 2 s cannot be met beside 'x' = 1 at 2 s")
refused("push.lua --goal other=1", "the goal 'other' = 1 at 2 s cannot be met: the controls do not change it")

-- ---- goals, costs and bounds of the scene ----

-- A push of at most U: u = clip(a (T/2 - t)) with s = U/a of T/2 = 1 s in which it is linear. Its distance, (2/m) U (1/2 - s^2/6),
-- is 1 with m = 2 for s = 0.8, between knots, and U as below; its cost is 2 U^2 (1 - 2 s/3). The goal's y and z hold by themselves.
write("bounded.lua", [[
local most = param("most", 10)
local scene = hooke.scene { duration = 2, fps = param("fps", 5), integrator = "rk4", dt = 0.1 }
local push = scene:control("push", { knots = 11, min = -most, max = most })
local p = scene:particle { position = { 0, 0, 0 }, mass = 2 }
scene:force("field", { f = function(t) return push(t), 0, 0 end })
scene:goal { particle = p, position = { 1, 0, 0 }, velocity = { 0, 0, 0 } }
if param("early", false) then scene:goal { measure = "x[1]", value = 0.25, at = 1 } end
if param("again", false) then scene:goal { measure = "x[1]", value = 2 } end
local way = param("cost", "")
if way == "squares" then scene:cost(function(s) return push(s.t) ^ 2 end) end
if way == "none" then scene:cost(function(s) return push(s.t) end) end
return scene
]])
local s = 0.8
local U = 1 / (1 / 2 - s * s / 6)
cost, iterations, text = optimum(("bounded.lua most=%.17g"):format(U))
assert(math.abs(cost / (2 * U * U * (1 - 2 * s / 3)) - 1) < 1e-10 and iterations == 1, text)
assert(text:find("x%[1%] +1 at 2 s"), text)
refused("bounded.lua most=1.5", "the goal 'x[1]' = 1 at 2 s cannot be met within the bounds of the controls")
refused("bounded.lua most=1 push='2: 0 3'", "bounded.lua:3: control 'push': the value 3 at knot 2 is above max, 1")
refused("bounded.lua again=true", "bounded.lua:8: goal: x[1] at 2 s is 1 already (line 6), and cannot be 2")

-- Beside it 1/4 at half of the time: x is a cubic on both sides, and the push linear. Where the speed there is w, a side from rest
-- to d and w in 1 s costs m^2 (12 d^2 - 12 d w + 4 w^2), the other the same with 1 - d; both together least for w = 3/4.
local m2, w2 = 4, 3 / 4
local both = m2 * (12 / 16 - 12 * w2 / 4 + 4 * w2 ^ 2 + 12 * 9 / 16 - 12 * w2 * 3 / 4 + 4 * w2 ^ 2)
cost, text = cost_of("bounded.lua most=30 early=true")
assert(math.abs(cost / both - 1) < 1e-10 and text:find("x%[1%] +0.25 at 1 s"), ("%g\n%s"):format(both, text))

-- The squares as a cost of the scene, by the trapezium rule over frames h apart: h^2/12 times the integral of (u^2)'' more,
-- 1.2e-3, and by what the optimum makes of that, some of its square.
cost, text = cost_of("bounded.lua fps=50 cost=squares")
assert(math.abs(cost - 6 - 0.02 ^ 2 / 12 * 2 * 3 ^ 2 * 2) < 3e-6, text)

-- ---- a cost of the state, without goals: the linear quadratic regulator of x'' = u, by Riccati's equation backwards from 0 ----

write("regulator.lua", [[
local scene = hooke.scene { duration = 2, fps = param("fps", 100), integrator = "rk4", dt = 0.02 }
local u = scene:control("u", { knots = 41, duration = 2 })
local p = scene:particle { position = { 1, 0, 0 } }
scene:force("field", { f = function(t) return u(t), 0, 0 end })
scene:cost(function(s) return s:position(p)[1] ^ 2 + s:velocity(p)[1] ^ 2 + u(s.t) ^ 2 end)
return scene
]])
local P = { 0, 0, 0 } -- the matrix { { P1, P2 }, { P2, P3 } }
local function moved(h, r) return P[1] + h * (1 - r[2] * r[2]), P[2] + h * (r[1] - r[2] * r[3]), P[3] + h * (2 * r[2] + 1 - r[3] * r[3]) end
for _ = 1, 20000 do P = { moved(1e-4, { moved(5e-5, P) }) } end -- the midpoint rule: to 1e-9
cost, iterations, text = optimum("regulator.lua")
-- The trapezium rule over frames and controls that are linear between knots cost h^2/12 of them more, about: 1e-5.
assert(cost > P[1] and cost < P[1] + 3e-5 and iterations < 30, ("%.9g\n%s"):format(P[1], text))
-- By transcription the same sum, of which Newton's method has the second derivatives: a quadratic program, up to their differences.
local by_states, fewer = optimum("regulator.lua --way transcription")
assert(math.abs(by_states / cost - 1) < 1e-10 and fewer <= 3, ("%.12g, not %.12g"):format(by_states, cost))
-- At frames that are farther apart than the knots the cost would be 1.01, below the least there is.
code, text = hooke("optimise regulator.lua fps=10 --most 5")
assert(code == 2 and text:find("the cost is taken at frames, 1/10 s apart, and the knots of u are 0.05 s apart: fps = 20 or more", 1, true),
  text)

-- The push itself has no least integral but by its bounds: what it can be with x = 1 and v = 0 is m v = 0.
cost, text = cost_of("bounded.lua cost=none")
assert(math.abs(cost) < 1e-6, text)

-- A muscle brings two particles d = 0.4 m nearer in T = 1 s, from rest to rest: 12 u^2 d^2/T^3 with their reduced mass u = 3/4 kg, by
-- a tension that is linear in time.
write("muscle.lua", [[
local scene = hooke.scene { duration = 1, fps = 10, integrator = "rk4", dt = 0.025 }
local tension = scene:control("tension", { knots = 5, help = "N" })
local p, q = scene:particle { position = { 0, 0, 0 }, mass = 1 }, scene:particle { position = { 1, 0, 0 }, mass = 3 }
scene:force("muscles", { edges = { { p, q } }, tension = tension })
scene:measure("distance", function(s) return s:position(q)[1] - s:position(p)[1] end)
scene:measure("rate", function(s) return s:velocity(q)[1] - s:velocity(p)[1] end)
return scene
]])
cost, iterations, text = optimum("muscle.lua --goal distance=0.6,rate=0")
assert(math.abs(cost / (12 * 0.75 ^ 2 * 0.16) - 1) < 1e-10 and iterations == 1, text)

-- ---- by transcription: unknown are the states at knots as well ----

-- Rest to rest is linear with a square as cost: one step. Its states and controls are exact to rounding.
cost, iterations, text = optimum("push.lua --goal x=1,v=0 --way transcription")
assert(math.abs(cost - 6) < 6e-12 and iterations == 1, text)
cost, iterations, text = optimum("push.lua --goal x=1,v=0 k=18 --way transcription")
local shooting = optimum("push.lua --goal x=1,v=0 k=18")
assert(math.abs(cost / shooting - 1) < 1e-10 and iterations == 1, text)
cost, iterations, text = optimum(("bounded.lua most=%.17g --way transcription"):format(U))
assert(math.abs(cost / (2 * U * U * (1 - 2 * s / 3)) - 1) < 1e-10 and iterations == 1, text)
refused("bounded.lua most=1.5 --way transcription", "the goal 'x[1]' = 1 at 2 s cannot be met within the bounds of the controls")
cost, text = cost_of("bounded.lua fps=50 cost=squares --way transcription") -- as by shooting above
assert(math.abs(cost - 6 - 0.02 ^ 2 / 12 * 2 * 3 ^ 2 * 2) < 3e-6, text)
refused("lone.lua --goal x=1 which=endless --way transcription", "the cost has no least value near these controls")
refused("push.lua knots=8 --goal x=1 --way transcription", "lies within a step")

-- A particle that is carried off by a tenth of a g t^2/2: linear, so that the first step is the optimum, from a run or from rest at
-- all knots, and at once or led through other distances.
write("led.lua", [[
local far = param("far", 1)
local scene = hooke.scene { duration = 2, fps = 5, integrator = "rk4", dt = 0.1 }
local push = scene:control("push", { knots = 11 })
local p = scene:particle { position = { 0, 0, 0 } }
scene:force("field", { f = function(t) return push(t) - 1, 0, 0 end })
scene:goal { particle = p, position = { far, 0, 0 }, velocity = { 0, 0, 0 } }
return scene
]])
local led = 12 / 8 + 2 -- rest to rest, and as much force against what carries it off
cost, iterations, text = optimum("led.lua --way transcription --guess still")
assert(math.abs(cost - led) < 1e-10 and iterations == 1, text)
cost, iterations, text = optimum("led.lua --way transcription --guess still --through far=0,0.5,1")
assert(math.abs(cost - led) < 1e-10 and iterations == 3, text)
refused("led.lua far=1 --way transcription --through far=0,1", "--through: far is given already")

-- From (a, b) and at rest to where x y = 1 in 2 s, by whatever speed: 3 d^2/T^3 to a point at the distance d, by a force that falls
-- linearly to 0. The measure alone is bent: with its second derivatives Newton's steps converge quadratically.
write("bent.lua", [[
local scene = hooke.scene { duration = 2, fps = 5, integrator = "rk4", dt = 0.1 }
local east, north = scene:control("east", { knots = 11 }), scene:control("north", { knots = 11 })
local p = scene:particle { position = { 0.5, 0.2, 0 } }
scene:force("field", { f = function(t) return east(t), north(t), 0 end })
scene:measure("product", function(s) return s:position(p)[1] * s:position(p)[2] end)
scene:goal { measure = "product", value = 1 }
return scene
]])
local low, high = 0.5, 3
for _ = 1, 60 do
  local x = (low + high) / 2
  if x - 0.5 - (1 / x - 0.2) / x ^ 2 < 0 then low = x else high = x end
end
local bent = 3 / 8 * ((low - 0.5) ^ 2 + (1 / low - 0.2) ^ 2)
cost, iterations, text = optimum("bent.lua --way transcription")
assert(math.abs(cost / bent - 1) < 1e-9 and iterations <= 7, ("%.12g\n%s"):format(bent, text))

-- ---- goals with a range ----

-- Thrown upwards at 1 m/s and back as fast after 1 s below a ceiling l <= 1/6 m: 8/(9 l), by a force that is linear in time until 3 l, 0
-- along the ceiling, and linear again (Bryson and Ho, Applied Optimal Control, 1975, 3.11). With l = 0.1 m both corners are at knots.
write("ceiling.lua", [[
local l = param("l", 0.1)
local scene = hooke.scene { duration = 1, fps = 10, integrator = "rk4", dt = 0.1 }
local push = scene:control("push", { knots = 11 })
local p = scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 } }
scene:force("field", { f = function(t) return push(t), 0, 0 end })
scene:measure("x", function(s) return s:position(p)[1] end)
for k = 1, 9 do scene:goal { measure = "x", max = l, at = k / 10 } end
scene:goal { particle = p, position = { 0, 0, 0 }, velocity = { -1, 0, 0 } }
if param("low", false) then scene:goal { measure = "x", min = 0.2, max = 0.1, at = 0.45 } end
if param("twice", false) then scene:goal { measure = "x", min = 0.05, at = 0.5 } end
if param("both", false) then scene:goal { measure = "x", value = 1, min = 0.2, at = 0.45 } end
return scene
]])
for _, way in ipairs { "shooting", "transcription" } do
  cost, iterations, text = optimum("ceiling.lua --way " .. way)
  assert(math.abs(cost / (8 / 0.9) - 1) < 1e-9 and iterations == 1, text) -- linear: rounding, of 11 values
  assert(text:find("x +<= 0.1 at 0.3 s"), text)
  assert(read("out/optimise/ceiling/optimum.json"):find('"max":0.1', 1, true))
  -- A ceiling that is not reached costs nothing: 4 by a force of -2 at all times, as high as 1/4 m.
  cost = cost_of("ceiling.lua l=0.26 --way " .. way)
  assert(math.abs(cost - 4) < 1e-9, cost)
end
-- Round a disc of 0.5 m by way of its top: where the point at half of the time is (c, y), 6 + 24 c^2 to the side and 24 y^2 - 1.2 y +
-- 0.01875 upwards; along the disc's edge 12.01875 - 1.2 y, of which the bent edge leaves a twentieth of the curvature.
write("round.lua", [[
local scene = hooke.scene { duration = 2, fps = 10, integrator = "rk4", dt = 0.1 }
local east, north = scene:control("east", { knots = 21 }), scene:control("north", { knots = 21 })
local p = scene:particle { position = { -1, 0.05, 0 } }
scene:force("field", { f = function(t) return east(t), north(t), 0 end })
scene:measure("far", function(s) return math.sqrt(s:position(p)[1] ^ 2 + s:position(p)[2] ^ 2) end)
for k = 1, 19 do scene:goal { measure = "far", min = 0.5, at = k / 10 } end
scene:goal { particle = p, position = { 1, 0, 0 }, velocity = { 0, 0, 0 } }
return scene
]])
cost, iterations, text = optimum("round.lua --way transcription")
assert(math.abs(cost - 11.41875) < 1e-8 and iterations <= 16, text)

refused("ceiling.lua low=true", "goal: min: 0.2 is above max, 0.1: no value of x lies between")
refused("ceiling.lua twice=true", "goal: x at 0.5 s has a goal already (line 7): give a value, or min and max together")
refused("ceiling.lua both=true", "goal: min and max are of a measure without a value")

-- A push of at most 1 N brings 1 kg from rest to rest by 1 m in 2 s and no further; by no way a value beyond its bound is tried.
write("far.lua", [[
local scene = hooke.scene { duration = 2, fps = 20, integrator = "rk4", dt = 0.05 }
local push = scene:control("push", { knots = 41, min = -1, max = 1 })
local p = scene:particle { position = { 0, 0, 0 } }
scene:force("field", { f = function(t) return push(t), 0, 0 end })
scene:goal { particle = p, position = { 1.02, 0, 0 }, velocity = { 0, 0, 0 } }
return scene
]])
for _, way in ipairs { "shooting", "transcription" } do
  refused("far.lua --way " .. way, "the goal 'x[1]' = 1.02 at 2 s cannot be met within the bounds of the controls")
end

-- ---- bounds that a guess of 0 touches, and knots that are closer than the scene's steps ----

-- A rocket falls 5 m from rest and lands in 2 s: a push of 0 at least, of which the first guess is at the bound. Without the bound it
-- is rest to rest against g, 2 g^2 + 12 25/8 with a force of g - 7.5 + 7.5 t: inside.
write("rocket.lua", [[
local scene = hooke.scene { duration = 2, fps = 10, integrator = "rk4", dt = 0.1 }
local push = scene:control("push", { knots = 11, min = 0, max = 20 })
local p = scene:particle { position = { 0, 0, 5 } }
scene:force("field", { f = function(t) return 0, 0, push(t) - 9.81 end })
scene:goal { particle = p, position = { 0, 0, 0 }, velocity = { 0, 0, 0 } }
return scene
]])
for _, way in ipairs { "shooting", "transcription" } do
  cost, text = cost_of("rocket.lua --refine 2 --way " .. way) -- 41 knots 0.05 s apart, steps of 0.1 s
  assert(math.abs(cost - 2 * 9.81 ^ 2 - 37.5) < 1e-9 * cost and text:find("steps of 0.05 s", 1, true), text)
end

-- ---- a crane whose rope is a rigid bar: shooting through constraints, replayed by another method ----

write("crane.lua", [[
local scene = hooke.scene { duration = 6, fps = 20, integrator = "leapfrog", dt = 1e-2 }
local drive = scene:control("drive", { knots = 13 })
local trolley = scene:particle { position = { 0, 0, 0 }, mass = 50 }
local load = scene:particle { position = { 0, 0, -4 }, mass = 20 }
scene:pin({ trolley }, { axes = { 1, 0, 0 } })
scene:force("gravity")
scene:constraint("bars", { edges = { { trolley, load } } })
scene:force("field", { f = function(t, _, _, _, _, _, _, id) return id == trolley and drive(t) or 0, 0, 0 end })
for _, id in ipairs { trolley, load } do
  scene:measure("x" .. id, function(s) return s:position(id)[1] end)
  scene:measure("v" .. id, function(s) return s:velocity(id)[1] end)
end
return scene
]])
cost, iterations, text = optimum("crane.lua --goal x1=5,v1=0,x2=5,v2=0")
assert(iterations <= 5, text) -- a swing of 0.2 rad is nearly linear
local goals = 0
for off, replayed in text:gmatch("off by +(%S+), by dop853 +(%S+)") do
  assert(math.abs(tonumber(off)) < 1e-9 and math.abs(tonumber(replayed)) < 1e-3, text) -- order 2 at steps of 1e-2 s
  goals = goals + 1
end
assert(goals == 4 and cost > 0, text)

-- ---- what is refused ----

write("asked.lua", (read("bounded.lua"):gsub("return push%(t%), 0, 0", "return push(t) + now, 0, 0")
  :gsub("(scene:force)", "local now = push(0)\n%1", 1)))
refused("asked.lua --way transcription", "control 'push': the script asks for its value while it makes the scene")

refused("push.lua --goal x=1 --guess still", "--guess and --through are for --way transcription")
refused("push.lua --goal x=1 --way transcription --through k", "--through: 'k' is not PARAMETER=NUMBER,NUMBER")
refused("push.lua --goal x=1 --way transcription --through k=1,b", "--through: 'b' is not a number")
refused("push.lua --goal x=1 --way transcription --through k=1,1", "--through: 1 is there twice")
refused("push.lua", "no goal: scene:goal{} in the script, or --goal MEASURE=NUMBER")
refused("push.lua --goal x", "--goal: 'x' is not MEASURE=NUMBER")
refused("push.lua --goal x=nan", "--goal: 'x=nan' is not MEASURE=NUMBER")
refused("push.lua --goal x=1,x=2", "--goal: x is there twice")
refused("push.lua --goal y=1", "the scene has no measure 'y'")
refused("push.lua --goal x=1 --by pusch", "the scene has no control 'pusch'; did you mean 'push'?")
refused("push.lua --goal x=1 push='2: 1 b'", "'b' is not a finite number")

runs.close()
