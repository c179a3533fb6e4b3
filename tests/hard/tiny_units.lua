--[[
what: a chain of 1 mm and 1 mg that rings 400 times a second: millimetres, milligrams, milliseconds
right: closed form, the slowest normal mode of a chain held at one end
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: a hundredth of the amplitude; leapfrog at h = 5e-5 s lags by (h w)^2/24 w T = 8e-3 of it after two
-- periods.
return require("_chain_mode") {
  spacing = 1.25e-4, mass = 1.25e-7, k = 23, amplitude = 1e-5,
  scene = { duration = 5e-3, fps = 2e4, tol = 1e-8, accuracy = 1e-7 },
}
