--[[
what: three unequal masses on three springs tumble about each other through three dimensions, strained by half
right: tests/study/answers_motion.c, printed with 17 digits
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4
]]
-- The bound: no motion is faster than w = 20 1/s; bdf2 at h = 1/1000 s lags by (h w)^2/3 w T = 5e-3 of 0.5 m; twice
-- that.
local x = { { 0, 0, 0 }, { 1.5, 0, 0.25 }, { 0.25, 1.25, 0 } }
local v = { { 0, -1, 0.5 }, { 0, 2, 0 }, { -1, 0, -1 } }
local mass, k, rest = { 1, 2, 0.5 }, { 100, 50, 80 }, { 1, 1.25, 1 }
local scene = hooke.scene { duration = 2, fps = 500, tol = 1e-8, accuracy = 6e-3 }

for i = 1, 3 do scene:particle { position = x[i], velocity = v[i], mass = mass[i] } end
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 }, { 3, 1 } }, k = k, rest = rest })

local answer = {
  0.28472884493876373, 1.5971525747339483, -0.21152530038982625,
  0.72264951978599727, 2.2656179489317745, 0.19210020623457505,
  0.78994423097848369, 0.99322305480500539, 0.65464977584135235,
}
scene:exact(function(t) if t == 2 then return table.unpack(answer) end end)
return scene
