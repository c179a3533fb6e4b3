--[[
what: a strained spring is damped out within 10 ms, but for the spin, which keeps its length and three tenths of the
  energy for ever; the work of the damping hides who loses the spin as well
right: tests/study/answers_motion.c, printed with 17 digits
must: dopri5, esdirk4, arkode
also: rk4 dt=1e-3; rk4 dt=2e-3; implicit_midpoint dt=1e-3; bdf2 dt=1e-3; stoermer dt=5e-4
]]
-- The bound: a thirtieth of the circle's radius, 48 turns on; w = sqrt(k/m) = 1006 1/s.
local scene = hooke.scene { duration = 0.3, fps = 60, tol = 1e-9, accuracy = 5e-3 }

scene:particle { position = { -0.5, 0, 0 }, velocity = { 0, -75, 0 }, mass = 0.00025 }
scene:particle { position = { 0, 0, 0 }, mass = 0.02 }
scene:force("springs", { edges = { { 1, 2 } }, k = 250, damping = 0.15, rest = 0 })

local answer = {
  -0.19680254884703908, -0.27408980280337867, 0,
  -0.0037899681394120258, -0.27782387746495777, 0,
}
scene:exact(function(t) if t == 0.3 then return table.unpack(answer) end end)
return scene
