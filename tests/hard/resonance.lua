--[[
what: steps of a quarter of a period of a hardening spring: stable on paper (h w = 1.5), resonant with its nonlinearity
right: tests/study/answers_springs.c, printed with 17 digits
must: dopri5, esdirk4, cvode, arkode
also: leapfrog dt=0.2; rk4 dt=0.1; stoermer dt=0.01; implicit_midpoint dt=0.2
]]
-- The bound: a hundredth of the amplitude, 50 periods on. w = sqrt(40 + 3/4 10) = 6.9 1/s at the amplitude of 1 m.
local scene = hooke.scene { duration = 50, fps = 4.4, tol = 1e-8, accuracy = 1e-2 }

scene:particles { positions = { { 0, 0, 0 }, { 1, 0, 0 } }, mass = 1 }
scene:pin { 1 }
scene:force("springs", { edges = { { 1, 2 } }, k = 40, rest = 0 })
scene:force("cubic_springs", { edges = { { 1, 2 } }, k = 10, rest = 0 })

local answer = {
  0, 0, 0,
  0.3967195577058399, 0, 0,
}
scene:exact(function(t) if t == 50 then return table.unpack(answer) end end)
return scene
