--[[
what: a circle that a long step closes too fast: at the end it is a whole turn ahead, and looks right
right: closed form, a steady rotation
must: dopri5, esdirk4
also: leapfrog dt=0.1; implicit_midpoint dt=0.1; stoermer dt=0.1
]]
-- The bound: a tenth of the radius, at all frames. A step of h w = 1 turns leapfrog by exactly 60 degrees: 22 turns in
-- 132 steps instead of 21.008, 0.05 m off at the end.
local w = 10 -- 1/s
local scene = hooke.scene { duration = 13.2, fps = 10, tol = 1e-8, accuracy = 0.1 }

scene:particle { position = { 1, 0, 0 }, velocity = { 0, w, 0 }, mass = 1 }
scene:force("central", { strength = w * w })

scene:exact(function(t) return math.cos(w * t), math.sin(w * t), 0 end)
return scene
