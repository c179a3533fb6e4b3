-- hooke optimise --way transcription with constraints: a pendulum on a rigid bar is swung up and over, whose optimum is known by
-- multipliers, from the states of the run and from one that stands still; and a crane's load on a bar. By the steps of both methods
-- that project.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "optimise", "--quiet")

local function optimum(words, wanted)
  local code, text = runs.run(words)
  local cost, iterations = text:match("optimum 1: (%S+) after (%d+) iterations")
  assert(code == (wanted or 0) and cost, text)
  for off in text:gmatch("off by +(%S+),") do assert(math.abs(tonumber(off)) < 1e-9, text) end
  return tonumber(cost), tonumber(iterations), text
end

-- q'' = u - sin q from rest at 0 to rest at pi in 4 s; q is without a jump but where the bar points to -x.
runs.write("swing_up.lua", [[
local scene = hooke.scene { duration = 4, fps = 10, integrator = param("method", "leapfrog"), dt = param("h", 0.01) }
local torque = scene:control("torque", { knots = 41, duration = 4 })
local o, p = scene:particle { position = { 0, 0, 0 } }, scene:particle { position = { 0, 0, -1 } }
scene:pin { o }
scene:force("gravity", { g = { 0, 0, -1 } })
scene:constraint("bars", { edges = { { o, p } } })
scene:force("field", { only = { p }, f = function(t, x, _, z) return -torque(t) * z, 0, torque(t) * x end })
scene:measure("q", function(s) local x = s:position(p) return math.pi / 2 + math.atan(x[3], x[1]) end)
scene:measure("w", function(s)
  local x, v = s:position(p), s:velocity(p)
  return (x[1] * v[3] - x[3] * v[1]) / (x[1] ^ 2 + x[3] ^ 2)
end)
return scene
]])

-- u = -l2/2, l1' = l2 cos q, l2' = -l1: the end of q, w and the integral of u^2 from l1 and l2 at the start, by rk4.
local function shoot(l1, l2)
  local function f(y) return { y[2], -y[4] / 2 - math.sin(y[1]), y[4] * math.cos(y[1]), -y[3], y[4] ^ 2 / 4 } end
  local function at(y, h, slope)
    local z = {}
    for i = 1, 5 do z[i] = y[i] + h * slope[i] end
    return z
  end
  local y, steps = { 0, 0, l1, l2, 0 }, 1000
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

local goals = "swing_up.lua --goal q=3.141592653589793,w=0 "
local by_shooting = optimum(goals)
local first, second = runs.read("out/optimise/swing_up/1-torque.txt"):match("^%S+ (%S+) (%S+)")
local l1, l2 = 2 * (second - first) / (4 / 40), -2 * tonumber(first)
for _ = 1, 30 do
  local y, d = shoot(l1, l2), 1e-6
  local a, b = shoot(l1 + d, l2), shoot(l1, l2 + d)
  local j11, j12, j21, j22 = (a[1] - y[1]) / d, (b[1] - y[1]) / d, (a[2] - y[2]) / d, (b[2] - y[2]) / d
  local r1, r2, det = y[1] - math.pi, y[2], j11 * j22 - j12 * j21
  l1, l2 = l1 - (r1 * j22 - r2 * j12) / det, l2 - (r2 * j11 - r1 * j21) / det
end
local exact = shoot(l1, l2)
assert(math.abs(exact[1] - math.pi) < 1e-9 and math.abs(exact[2]) < 1e-9)

for _, guess in ipairs { "run", "still" } do
  local cost, iterations, text = optimum(goals .. "--way transcription --guess " .. guess)
  assert(math.abs(cost / by_shooting - 1) < 1e-9 and iterations <= 25, text) -- 10 to 15 as found here
  assert(math.abs(cost / exact[5] - 1) < 2e-4, ("%.9g\n%s"):format(exact[5], text)) -- leapfrog at 0.01 s: 1e-4, falls with h^2
end
-- symplectic Euler is of order 1, which the independent method says
local other = optimum(goals .. "--way transcription method=symplectic_euler", 2)
assert(math.abs(other / exact[5] - 1) < 2e-2)

-- ---- a load on a bar below a trolley, by either way ----

runs.write("crane.lua", [[
local scene = hooke.scene { duration = 6, fps = 20, integrator = "leapfrog", dt = 1e-2 }
local drive = scene:control("drive", { knots = 13 })
local trolley = scene:particle { position = { 0, 0, 0 }, mass = 50 }
local load = scene:particle { position = { 0, 0, -4 }, mass = 20 }
scene:pin({ trolley }, { axes = { 1, 0, 0 } })
scene:force("gravity")
scene:constraint("bars", { edges = { { trolley, load } } })
scene:force("field", { only = { trolley }, f = function(t) return drive(t), 0, 0 end })
for k, id in ipairs { trolley, load } do
  local name = k == 1 and "trolley" or "load"
  scene:measure(name, function(s) return s:position(id)[1] end)
  scene:measure(name .. "_speed", function(s) return s:velocity(id)[1] end)
end
return scene
]])
goals = "crane.lua --goal trolley=5,trolley_speed=0,load=5,load_speed=0 "
local cost, iterations, text = optimum(goals .. "--way transcription")
assert(math.abs(cost / optimum(goals) - 1) < 1e-8 and iterations <= 5, text)
runs.close()
