--[[
what: no damping, 5,000 steps of a sixteenth of a second or 10,000 of half of it, 77 periods
right: closed form, the two modes of springs without rest length
must: stoermer5, blanes_moan, dopri5, rk4, stoermer
also: leapfrog dt=1/32; symplectic_euler dt=1/32
]]
-- The bound: a hundredth of the amplitude. The faster mode turns by w T = 485 rad; order 4 is off by (h w)^4/120 of it,
-- 4e-4, order 2 by (h w)^2/24, 0.2.
return require("_two_modes") { duration = 300, fps = 16, tol = 1e-9, accuracy = 1e-2 }
