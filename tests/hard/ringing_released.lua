--[[
what: stiff links are held stretched, let go in mid-run and ring: the first frames show nothing of it
right: tests/study/answers_springs.c, printed with 17 digits: ringing_links.lua, a tenth of a second later
must: arkode, dopri5
also: implicit_midpoint dt=1/30; implicit_midpoint dt=1/600; bdf2 dt=1/600; xpbd dt=1/30
]]
-- The bound: as in ringing_links.lua.
local scene = hooke.scene { duration = 0.8, fps = 30, tol = 1e-8, accuracy = 3e-2 }

scene:particles { positions = { { 0, 0, 0 }, { 1, 0, 0 }, { 1.504, 1.008 * math.sqrt(0.75), 0 } }, mass = 1 }
scene:pin { 1 }
scene:pin({ 2, 3 }, { release = 0.1 })
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 1e6, rest = 1 })

local answer = {
  0, 0, 0,
  0.97031827435609327, -0.25492745044802747, 0,
  1.0060490597222762, 0.7506908430223022, 0,
}
scene:exact(function(t) if t == 0.8 then return table.unpack(answer) end end)
return scene
