--[[
what: a stiff spring rings with a millimetre while it flies at 1 km/s: its energy is nothing beside that of the flight
right: closed form, a ringing about a steady flight
must: arkode, dopri5
also: backward_euler dt=1/240; bdf2 dt=1/1200; imex dt=1/240; implicit_midpoint dt=1/240
]]
-- The bound: a tenth of what rings.
local scene = hooke.scene { duration = 0.05, fps = 240, tol = 1e-10, accuracy = 1e-4 }
local K, a, V = 1e8, 1e-3, 1000 -- N/m, m, m/s; masses of 1 kg

scene:particles { positions = { { 0, 0, 0 }, { 1 + a, 0, 0 } }, velocities = { { 0, V, 0 }, { 0, V, 0 } }, mass = 1 }
scene:force("springs", { edges = { { 1, 2 } }, k = K, rest = 1 })

scene:exact(function(t)
  local centre, half = (1 + a) / 2, (1 + a * math.cos(math.sqrt(2 * K) * t)) / 2
  return centre - half, V * t, 0, centre + half, V * t, 0
end)
return scene
