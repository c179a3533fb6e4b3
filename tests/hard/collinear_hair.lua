--[[
what: a hair that is straight to 1e-7 m falls; its flexion springs lie along the others, so nothing bends it at first
right: tests/study/answers_springs.c, printed with 17 digits
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, arkode, cvode, implicit_midpoint,
  implicit_trapezoid, tr_bdf2, esdirk4
]]
-- The bound: the fall's h^2 a-dot/12 stays far below; what rings along the hair does so with g/w^2 at w = 150 1/s or
-- more, 4e-4 m, and in 0.2 s a method that gets its phase wrong is off by as much.
local scene = hooke.scene { duration = 0.2, fps = 240, accuracy = 5e-4 }

local positions, structural, flexion = {}, {}, {}
for i = 0, 11 do
  positions[i + 1] = { 0.02 * i, i % 2 == 1 and 1e-7 or -1e-7, 0 }
  if i > 0 then structural[i] = { i, i + 1 } end
  if i > 1 then flexion[i - 1] = { i - 1, i + 1 } end
end
scene:particles { positions = positions, mass = 1e-4 }
scene:pin { 1, 2 }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("springs", { edges = structural, k = 100, label = "structural" })
scene:force("springs", { edges = flexion, k = 10, label = "flexion" })

local answer = {
  0, -1e-07, 0,
  0.02, 1e-07, 0,
  0.032954831918402544, 2.2114664384452218e-07, -0.01601672309371562,
  0.037841114252402424, 1.7493430341084077e-07, -0.035685706806864309,
  0.042116887885277792, 1.9883146586124688e-07, -0.055429811810918427,
  0.045560511965054405, 2.6402059160604857e-07, -0.075327599459070685,
  0.049602715954397273, 2.5655033726824305e-07, -0.095096846896553867,
  0.052620531186459114, 1.6901480204046699e-07, -0.11503067097297128,
  0.056686702604617809, 1.6682876894705938e-07, -0.13476883841596669,
  0.064558364412671189, 1.3167711001809452e-07, -0.15336904667819704,
  0.064904611384083006, 1.8364353782315432e-07, -0.17353070772867604,
  0.067450369343842087, 4.120943436544069e-08, -0.19346881819210034,
}
scene:exact(function(t) if t == 0.2 then return table.unpack(answer) end end)
return scene
