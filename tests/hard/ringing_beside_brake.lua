--[[
what: a light pair rings while a heavy body is braked: the work of the brake is a million times what the ringing holds
right: closed form, each on its own
must: dopri5, arkode
also: backward_euler dt=1/240; bdf2 dt=1/240; imex dt=1/240; rk4 dt=1/1200; stoermer dt=1/1200; implicit_midpoint dt=1/240
]]
-- The bound: a tenth of the amplitude of what rings, spread over three particles.
local scene = hooke.scene { duration = 0.05, fps = 240, tol = 1e-10, accuracy = 5e-5 }
local w, a, rate, V = 1e4, 1e-3, 20, 100 -- 1/s, m, 1/s, m/s

scene:particles { positions = { { 0, 0, 0 }, { 1 + a, 0, 0 } }, mass = 1e-3 }
scene:particle { position = { 0, 5, 0 }, velocity = { 0, 0, V }, mass = 1e3 }
scene:force("springs", { edges = { { 1, 2 } }, k = w * w * 1e-3 / 2, rest = 1 })
scene:force("drag", { rate = rate, only = { 3 } })

scene:exact(function(t)
  local centre, half = (1 + a) / 2, (1 + a * math.cos(w * t)) / 2
  return centre - half, 0, 0, centre + half, 0, 0, 0, 5, V / rate * (1 - math.exp(-rate * t))
end)
return scene
