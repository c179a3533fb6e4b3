-- Optima of motions that turn over, which are known by multipliers: a pendulum swung up, by shooting with Pontryagin's
-- equations here, and the cart-pole of Kelly, SIAM Review 59, 2017, whose cost is known to nine digits.
-- Under sanitizers the optima are the same there, and optimise.lua runs the same code.
if assert(os.getenv("HK_BUILD"), "HK_BUILD"):find("sanitize") then os.exit(77) end
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "optimise", "--quiet")

local function optimum(arguments)
  local code, text = runs.run(arguments)
  assert(code == 0, text)
  local cost, iterations = text:match("optimum 1: (%S+) after (%d+) iterations")
  return tonumber(cost), text, tonumber(iterations)
end

-- ---- a pendulum: q'' = u - sin q from rest at 0 to rest at pi in 4 s ----

runs.write("swing_up.lua", [[
local scene = hooke.scene { duration = 4, fps = 10, integrator = "rk4", dt = 0.02 }
local torque = scene:control("torque", { knots = 61, duration = 4 })
local p = scene:particle { position = { 0, 0, 0 } }
scene:force("field", { f = function(t, q) return torque(t) - math.sin(q), 0, 0 end })
scene:measure("q", function(s) return s:position(p)[1] end)
scene:measure("w", function(s) return s:velocity(p)[1] end)
return scene
]])
local cost, text = optimum("swing_up.lua --goal q=3.141592653589793,w=0")

-- u = -l2/2, l1' = l2 cos q, l2' = -l1: the end of q, w and the integral of u^2 from l1 and l2 at the start, by rk4.
local function shoot(l1, l2)
  local function f(y) return { y[2], -y[4] / 2 - math.sin(y[1]), y[4] * math.cos(y[1]), -y[3], y[4] ^ 2 / 4 } end
  local function at(y, h, slope)
    local z = {}
    for i = 1, 5 do z[i] = y[i] + h * slope[i] end
    return z
  end
  local y, steps = { 0, 0, l1, l2, 0 }, 2000
  local h = 4 / steps
  for _ = 1, steps do
    local a = f(y)
    local b = f(at(y, h / 2, a))
    local c = f(at(y, h / 2, b))
    local d = f(at(y, h, c))
    for i = 1, 5 do y[i] = y[i] + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]) end
  end
  return y
end

-- Newton's method from what the first two values of the optimum say: l2 = -2 u, l1 = 2 u'.
local first, second = runs.read("out/optimise/swing_up/1-torque.txt"):match("^%S+ (%S+) (%S+)")
local l1, l2 = 2 * (second - first) / (4 / 60), -2 * tonumber(first)
for _ = 1, 30 do
  local y, d = shoot(l1, l2), 1e-6
  local a, b = shoot(l1 + d, l2), shoot(l1, l2 + d)
  local j11, j12, j21, j22 = (a[1] - y[1]) / d, (b[1] - y[1]) / d, (a[2] - y[2]) / d, (b[2] - y[2]) / d
  local r1, r2, det = y[1] - math.pi, y[2], j11 * j22 - j12 * j21
  l1, l2 = l1 - (r1 * j22 - r2 * j12) / det, l2 - (r2 * j11 - r1 * j21) / det
end
local y = shoot(l1, l2)
assert(math.abs(y[1] - math.pi) < 1e-9 and math.abs(y[2]) < 1e-9)
assert(math.abs(cost - y[5]) < 1e-5 * y[5], ("%.9g\n%s"):format(y[5], text))

-- ---- a cart of 1 kg with a pole of 0.5 m and 0.3 kg: 1 m to the side and upright in 2 s ----

runs.write("cart_pole.lua", [[
local m1, m2, l, g = 1, 0.3, 0.5, 9.81
local scene = hooke.scene { duration = 2, fps = 20, integrator = "rk4", dt = 0.0125 }
local push = scene:control("push", { knots = 81, duration = 2 })
local p = scene:particle { position = { 0, 0, 0 } }
scene:force("field", { f = function(t, _, q, _, _, w) -- m of the cart, and the pole's angle
  local u, s, c = push(t), math.sin(q), math.cos(q)
  local d = m1 + m2 * s * s
  return (l * m2 * s * w * w + u + m2 * g * c * s) / d, -(l * m2 * c * s * w * w + u * c + (m1 + m2) * g * s) / (l * d), 0
end })
scene:measure("x", function(s) return s:position(p)[1] end)
scene:measure("q", function(s) return s:position(p)[2] end)
scene:measure("v", function(s) return s:velocity(p)[1] end)
scene:measure("w", function(s) return s:velocity(p)[2] end)
return scene
]])
cost, text = optimum("cart_pole.lua --goal x=1,q=3.141592653589793,v=0,w=0")
assert(math.abs(cost - 57.9447803) < 1e-5 * 57.9447803, text) -- knots 1/40 s apart cost 2.3e-4 more

-- By transcription in at most 30 iterations to the same optimum, as far as the steps between knots are equations that both hold.
local by_states, words, iterations = optimum("cart_pole.lua --goal x=1,q=3.141592653589793,v=0,w=0 --way transcription")
assert(math.abs(by_states / cost - 1) < 1e-9 and iterations <= 22, words) -- 20 as found here

-- One that is ended after a few iterations goes on with the next one, and comes to the same optimum, bit by bit.
local goals = "cart_pole.lua --goal x=1,q=3.141592653589793,v=0,w=0 --way transcription "
local function stopped(path, count)
  return ("sh -c '\"$@\" & p=$!; while [ $(cat %s/evaluations.json 2>/dev/null | grep -c penalty) -lt %d ]; do sleep 0.01; "
    .. "done; kill -9 $p' sh"):format(path, count)
end
runs.run(goals .. "--out stopped", stopped("stopped", 5))
local last
for found in runs.read("stopped/evaluations.json"):gmatch('"iteration":(%d+)') do last = tonumber(found) end
assert(last >= 5 and last < iterations, last)
local _, again = runs.run(goals .. "--out stopped --most " .. iterations + 1)
assert(again:match("optimum 1: [^,]*") == words:match("optimum 1: [^,]*"), again .. words)
assert(runs.read("stopped/1-push.txt") == runs.read("out/optimise/cart_pole/1-push.txt"))
local evaluations = io.open(runs.folder .. "/stopped/evaluations.json")
assert(not evaluations)

-- ---- the other good optimum of the cart and its pole, near whose values the search begins ----

runs.write("other.lua", (runs.read("cart_pole.lua"):gsub("knots = 81, duration = 2", [[knots = 41, duration = 2, start = start]])
  :gsub("^", [[
local coarse, start = { 1.9, 6.6, 9, 7.5, 3.5, 0.1, -2.6, -6.3, -12.1, -12.9, -3.9, 1.6, 3, 2.7, 1.9, 1.3, 0.8, 0.4, -0.1, -0.8, -1.9 }, {}
for k = 0, 40 do start[k + 1] = (coarse[k // 2 + 1] + coarse[(k + 1) // 2 + 1]) / 2 end
]], 1)))
cost, text = optimum("other.lua --goal x=1,q=3.141592653589793,v=0,w=0")
assert(math.abs(cost - 58.8076675) < 1e-4 * 58.8076675, text) -- knots 1/20 s apart cost 6.5e-5 more; the first optimum is 1.5e-2 less

-- ---- a search that has had more iterations than --most lets it have goes on by one ----

runs.run(goals .. "--out fewer", stopped("fewer", 5))
local code, one = runs.run(goals .. "--out fewer --most 2")
assert(code == 2 and one:find("it ended after as many iterations as --most", 1, true), one)

-- ---- Luxo's lamp jumps on the spot, from one that stands still with muscles that do nothing ----

cost, text, iterations = optimum(os.getenv("HK_ROOT") .. "/scripts/scenes/luxo.lua rest=true far=0 --way transcription --guess still")
assert(math.abs(cost - 1377.575201) < 1e-5 and iterations <= 30, text) -- as found here; the run and dop853 meet the goals

-- Over 0.3 m, led there by shorter jumps, to the optimum that IPOPT finds on the same steps; its posts are goals that stiff links tie.
cost, text, iterations = optimum(os.getenv("HK_ROOT") .. "/scripts/scenes/luxo.lua rest=true --way transcription --guess still "
  .. "--accuracy 1 --through far=0,0.02,0.1,0.2,0.3")
assert(math.abs(cost - 3208.164042) < 1e-5 and iterations <= 90, text)

runs.close()
