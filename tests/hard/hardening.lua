--[[
what: a spring without any stiffness at the start hardens to 145 1/s as it stretches, after the step was chosen
right: tests/study/answers_springs.c, printed with 17 digits
must: dopri5, tr_bdf2, esdirk4, cvode, arkode
also: leapfrog dt=2e-4; rk4 dt=2e-3; bdf2 dt=1e-3; implicit_midpoint dt=2e-4
]]
-- The bound: a hundredth of the amplitude of 0.084 m, eleven periods on.
local scene = hooke.scene { duration = 1, tol = 1e-7, accuracy = 1e-3 }

scene:particles { positions = { { 0, 0, 0 }, { 1, 0, 0 } }, velocities = { { 0, 0, 0 }, { 5, 0, 0 } }, mass = 1 }
scene:pin { 1 }
scene:force("cubic_springs", { edges = { { 1, 2 } }, k = 1e6, rest = 1 })

local answer = {
  0, 0, 0,
  1.0677068156854938, 0, 0,
}
scene:exact(function(t) if t == 1 then return table.unpack(answer) end end)
return scene
