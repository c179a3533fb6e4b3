--[[
what: two stiff links ring, which opens their angle by half a metre; long steps keep still and are content
right: tests/study/answers_springs.c, printed with 17 digits
must: arkode, dopri5
also: implicit_midpoint dt=1/30; implicit_midpoint dt=1/600; implicit_trapezoid dt=1/30; bdf2 dt=1/600;
  backward_euler dt=1/30; backward_euler dt=1e-3; xpbd dt=1/30
]]
-- The energy of the ringing is its action times w; the action is kept, and w (0.7e3 to 1.6e3 1/s) depends on the angle:
-- a moment of some 30 J per radian, which the mean of the springs' pull does not show. Ascher and Reich, SIAM J. Sci.
-- Comput. 21 (1999) 1045, on the midpoint rule's pitfalls.
-- The bound: several times the ringing itself, 8e-3 m.
local scene = hooke.scene { duration = 0.7, fps = 30, tol = 1e-8, accuracy = 3e-2 }

scene:particles { positions = { { 0, 0, 0 }, { 1, 0, 0 }, { 1.504, 1.008 * math.sqrt(0.75), 0 } }, mass = 1 }
scene:pin { 1 }
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 1e6, rest = 1 })

local answer = {
  0, 0, 0,
  0.97031827435609327, -0.25492745044802747, 0,
  1.0060490597222762, 0.7506908430223022, 0,
}
scene:exact(function(t) if t == 0.7 then return table.unpack(answer) end end)
return scene
