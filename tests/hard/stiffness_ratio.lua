--[[
what: a spring of 1 N/m carries one of 1e8 N/m, which is in equilibrium: only the slow motion is to be seen
right: closed form, the two modes of a linear chain
must: leapfrog, symplectic_euler, stoermer, blanes_moan, rk4, dopri5, arkode, cvode, implicit_midpoint,
  implicit_trapezoid, imex, bdf2, tr_bdf2, esdirk4
]]
-- The bound: order 2 at h = 1/120 s is off by h^2 w^3 T/3 = 1e-6 of 0.1 m; backward Euler by h w^2 T/2 = 1e-3 of it.
local scene = hooke.scene { duration = 0.5, accuracy = 1e-5 }
local k, K = 1, 1e8 -- N/m; masses of 1 kg

-- Modes (1, r) of [k + K, -K; -K, K], the slow one alone: all start at rest on it.
local mean, root = (k + 2 * K) / 2, math.sqrt(k * k + 4 * K * K) / 2
local slow = k * K / (mean + root) -- w^2, without cancellation
local r = K / (K - slow)
local x = { 0.1, 0.1 * r }

scene:particles { positions = { { 0, 0, 0 }, { 1 + x[1], 0, 0 }, { 2 + x[2], 0, 0 } }, mass = 1 }
scene:pin { 1 }
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = { k, K }, rest = 1 })

scene:exact(function(t)
  local c = math.cos(math.sqrt(slow) * t)
  return 0, 0, 0, 1 + x[1] * c, 0, 0, 2 + x[2] * c, 0, 0
end)
return scene
