--[[
what: a charge circles in a magnetic field, 8 turns; the force is across the velocity, neither damping nor stiffness
right: closed form, a helix of radius v m/(q B)
must: leapfrog, stoermer5, rk4, dopri5, implicit_midpoint, implicit_trapezoid, esdirk4
]]
-- The bound: leapfrog turns too fast by 5/12 (h w)^2 w T = 1.3e-2 rad at h = 1/4000 s, of a radius of 0.1 m; four times
-- that.
local w, v = 100, 10
local scene = hooke.scene { duration = 0.5, fps = 4000, tol = 1e-8, accuracy = 5e-3 }

scene:particle { position = { 0, 0, 0 }, velocity = { v, 0, 1 }, mass = 0.002 }
scene:force("magnetic", { B = { 0, 0, 4 }, charge = w * 0.002 / 4 })

scene:exact(function(t) return v / w * math.sin(w * t), v / w * (math.cos(w * t) - 1), t end)
return scene
