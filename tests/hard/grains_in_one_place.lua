--[[
what: two grains with the same centre, whose contact has no direction: they fly on as one, or as any rounding says
right: closed form, uniform motion: what has no direction pushes nowhere
must: none
also: leapfrog dt=1e-2
]]
-- The bound is far below the radius. A start off by 1e-14 m grows with exp(w t), w = 447 1/s, to the radius in 0.07 s: no
-- run can know where the grains are.
local scene = hooke.scene { duration = 0.1, fps = 1000, accuracy = 1e-6 }
scene:particles { positions = { { 0, 0, 0 }, { 0, 0, 0 } }, velocities = { { 1, 0, 0 }, { 1, 0, 0 } }, mass = 1 }
scene:force("soft_spheres", { radius = 0.1, stiffness = 1e5, friction = 0.5 })
scene:exact(function(t) return t, 0, 0, t, 0, 0 end)
return scene
