--[[
what: a particle at rest under a load that grows from zero: nothing yet that an error could be measured by
right: closed form, twice the integral of a sine
must: leapfrog, stoermer, stoermer5, rk4, dopri5, cvode, arkode, tr_bdf2, esdirk4, bdf2, implicit_midpoint
]]
-- The bound: order 2 leaves (p h)^2/12 = 1e-3 of A t/p = 0.16 m at h = 1/60 s; four times that.
local scene = hooke.scene { duration = 1, accuracy = 6e-4 }
local A, p = 1, 2 * math.pi -- m/s^2, 1/s

scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:force("gravity", { g = function(t) return A * math.sin(p * t), 0, 0 end })

scene:exact(function(t) return A / p * (t - math.sin(p * t) / p), 0, 0 end)
return scene
