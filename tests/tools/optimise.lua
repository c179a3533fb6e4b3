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

-- ---- a particle of 2 kg on a spring of k N/m, pushed: linear, so that the first step is the optimum ----

write("push.lua", [[
local control = require("control")
local k, knots = param("k", 0, "N/m"), param("knots", 11)
local push = control("push", { knots = knots, duration = 2 })
local scene = hooke.scene { duration = 2, fps = 5, integrator = "rk4", dt = 0.025 }
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
assert(read("out/optimise/push/optimum.json"):find('"sure":true', 1, true))
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

-- Forces that two goals cannot both have, and a goal that nothing changes.
refused("push.lua --goal x=1,twice=3", "the goal 'twice' cannot be met: the controls change it not at all, or not without")
refused("push.lua --goal other=1", "the goal 'other' cannot be met")

-- ---- what is refused ----

refused("push.lua", "no goal: --goal MEASURE=NUMBER")
refused("push.lua --goal x", "--goal: 'x' is not MEASURE=NUMBER")
refused("push.lua --goal x=nan", "--goal: 'x=nan' is not MEASURE=NUMBER")
refused("push.lua --goal x=1,x=2", "--goal: x is there twice")
refused("push.lua --goal y=1", "the scene has no measure 'y'")
refused("push.lua --goal x=1 --by pusch", "the scene has no control 'pusch'; did you mean 'push'?")
refused("push.lua --goal x=1 push='2: 1 b'", "'b' is not a finite number")

runs.close()
