--[[
what: the same stiffness ratio of 1e8, but the stiff spring rings with 1 mm
right: closed form, the two modes of a linear chain
must: cvode, arkode, dopri5
also: implicit_midpoint dt=1/240; implicit_midpoint dt=1/1200; backward_euler dt=1/240;
  backward_euler dt=1e-3; bdf2 dt=1/1200; implicit_trapezoid dt=1/240
]]
-- The bound: a tenth of what rings. Whoever damps the ringing away, at the step and at half the step, is off by 0.6 mm.
local scene = hooke.scene { duration = 0.05, fps = 240, tol = 1e-8, accuracy = 1e-4 }
local k, K = 1, 1e8 -- N/m; masses of 1 kg

-- Modes (1, r) of [k + K, -K; -K, K].
local mean, root = (k + 2 * K) / 2, math.sqrt(k * k + 4 * K * K) / 2
local w2 = { k * K / (mean + root), mean + root }
local r = { K / (K - w2[1]), (k + K - w2[2]) / K }
local size = { 0.1, 5e-4 }

local function positions(t)
  local a, b = size[1] * math.cos(math.sqrt(w2[1]) * t), size[2] * math.cos(math.sqrt(w2[2]) * t)
  return 1 + a + b, 2 + r[1] * a + r[2] * b
end

local x1, x2 = positions(0)
scene:particles { positions = { { 0, 0, 0 }, { x1, 0, 0 }, { x2, 0, 0 } }, mass = 1 }
scene:pin { 1 }
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = { k, K }, rest = 1 })

scene:exact(function(t)
  local a, b = positions(t)
  return 0, 0, 0, a, 0, 0, b, 0, 0
end)
return scene
