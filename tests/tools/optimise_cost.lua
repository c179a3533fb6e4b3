-- hooke optimise --way transcription of a scene's own cost, beside shooting, which takes the same sum over frames by adjoints: bent costs
-- of places, velocities and two controls, on bent motion, to goals, by two methods and with frames at knots alone and between them.
package.path = assert(os.getenv("HK_ROOT"), "HK_ROOT") .. "/tests/support/?.lua;" .. package.path
local runs = require("tool_runs").new(assert(os.getenv("HK_BUILD"), "HK_BUILD"), "optimise", "--quiet")

runs.write("bent.lua", [[
local scene = hooke.scene { duration = 2, fps = param("fps", 40), integrator = param("method", "rk4"), dt = 0.0125 }
local u = scene:control("u", { knots = 21, duration = param("last", 2) })
local w = scene:control("w", { knots = 21, duration = param("last", 2) })
local p = scene:particle { position = { 1, 0, 0 }, mass = 1.3 }
scene:force("central", { strength = 2, power = 3, per = "particle" })
scene:force("field", { f = function(t) return u(t), w(t), 0 end })
scene:cost(function(s)
  local x, v = s:position(p), s:velocity(p)
  return 1 - math.cos(x[1]) + 0.2 * x[2] ^ 4 + 0.3 * v[1] ^ 2 * v[2] ^ 2 + 0.5 * u(s.t) ^ 2 * (1 + x[1] ^ 2) + w(s.t) ^ 2
    + 0.1 * u(s.t) * v[1] * w(s.t)
end)
scene:goal { particle = p, position = { 0.2, 0.4, 0 } }
return scene
]])

local function optimum(words)
  local code, text = runs.run("bent.lua " .. words)
  local cost, iterations = text:match("optimum 1: (%S+) after (%d+) iterations")
  assert(code == 0 and cost, text)
  return tonumber(cost), tonumber(iterations)
end

-- Both end within 1e-7 of the controls, so that costs agree to 1e-13 or so of themselves; they have 12 digits.
for _, case in ipairs { "method=rk4", "method=leapfrog --accuracy 1", "fps=10", "fps=20" } do
  local by_states, few = optimum(case .. " --way transcription")
  local by_shooting, many = optimum(case)
  assert(math.abs(by_states / by_shooting - 1) < 1e-10, ("%s: %.12g, not %.12g"):format(case, by_states, by_shooting))
  assert(few <= 6 and few < many, ("%s: %d and %d iterations"):format(case, few, many)) -- 4 and 12 as found here
end
runs.refused("bent.lua last=1 --way transcription", "the cost is taken to 2 s, after the last knot of u at 1 s")
runs.close()
