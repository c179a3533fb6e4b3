--[[
what: a chain of a metre a thousand kilometres from the origin, where a coordinate has 1e-10 m
right: closed form, the slowest normal mode of a chain held at one end
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: a hundredth of the amplitude; leapfrog at h = 1/480 s lags by (h w)^2/24 w T = 4e-4 of it, and rounding
-- grows to some 1e-9 m.
return require("_chain_mode") {
  spacing = 0.125, mass = 0.0125, k = 80, amplitude = 0.05, origin = { 1e6, -1e6, 1e6 },
  scene = { duration = 0.7, fps = 480, tol = 1e-8, accuracy = 5e-4 },
}
