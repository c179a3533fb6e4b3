--[[
what: a load hums at 1800 Hz, which is zero at every step of a frame, be it cut in 1, 2, 3, 5, 6 or 10
right: closed form, twice the integral of a sine
must: dopri5, arkode
also: leapfrog dt=1/60; leapfrog dt=1/120; rk4 dt=1/60; bdf2 dt=1/60; leapfrog dt=1e-4
]]
-- The bound: a hundredth of the way A t/p = 0.035 m.
local scene = hooke.scene { duration = 0.2, accuracy = 3e-4 }
local A, p = 2000, 2 * math.pi * 1800 -- m/s^2, 1/s

scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:force("gravity", { g = function(t) return A * math.sin(p * t), 0, 0 end })

scene:exact(function(t) return A / p * (t - math.sin(p * t) / p), 0, 0 end)
return scene
