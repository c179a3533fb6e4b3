--[[
what: a chain of 1000 km and 80,000 t that swings once in ten hours: kilometres, tonnes, hours
right: closed form, the slowest normal mode of a chain held at one end
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: a hundredth of the amplitude; leapfrog at h = 250 s lags by (h w)^2/24 w T = 1e-3 of it after two periods.
return require("_chain_mode") {
  spacing = 1.25e5, mass = 1e7, k = 8, amplitude = 1e4,
  scene = { duration = 72000, fps = 0.004, tol = 1e-8, accuracy = 100 },
}
