--[[
what: no damping, a million steps, 10,000 periods: what damps or grows by 1e-6 a step is lost
right: closed form, the two modes of springs without rest length
must: stoermer5, dopri5
long: true
also: leapfrog dt=1/32; implicit_midpoint dt=1/16
]]
-- The bound: a twentieth of the amplitude. The faster mode turns by w T = 1e5 rad; order 4 is off by (h w)^4/120 of it,
-- 9e-2, order 2 by all of it.
return require("_two_modes") { duration = 62500, fps = 16, tol = 1e-8, accuracy = 5e-2 }
