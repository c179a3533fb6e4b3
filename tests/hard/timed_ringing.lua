--[[
what: a stiff spring rings under a load that changes in time, whose work hides what a long step damps away
right: closed form, a ringing about a slow forced motion
must: arkode, dopri5
also: backward_euler dt=1/240; bdf2 dt=1/240; bdf2 dt=1/1200; imex dt=1/240; implicit_midpoint dt=1/240
]]
-- The bound: a tenth of what rings.
local scene = hooke.scene { duration = 0.05, fps = 240, tol = 1e-8, accuracy = 1e-4 }
local K, a, A, p = 1e8, 1e-3, 10, 20 -- N/m, m, m/s^2, 1/s; masses of 1 kg

-- A free pair: its centre follows the load, A sin(p t) along x; its stretch a cos(w t) does not feel it.
scene:particles { positions = { { 0, 0, 0 }, { 1 + a, 0, 0 } }, mass = 1 }
scene:force("springs", { edges = { { 1, 2 } }, k = K, rest = 1 })
scene:force("gravity", { g = function(t) return A * math.sin(p * t), 0, 0 end })

scene:exact(function(t)
  local centre = (1 + a) / 2 + A / p * (t - math.sin(p * t) / p)
  local half = (1 + a * math.cos(math.sqrt(2 * K) * t)) / 2
  return centre - half, 0, 0, centre + half, 0, 0
end)
return scene
