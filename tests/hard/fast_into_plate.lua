--[[
what: a particle hits a plate of no thickness at 100 m/s, three metres a frame: a step may end far behind the plate
right: closed form: straight there, and straight back
must: leapfrog, stoermer, rk4, symplectic_euler
]]
-- The bound: paths are straight and the plate rests: rounding of positions of metres.
local v, z0, r = 100, 1, 5e-4
local scene = hooke.scene { duration = 0.1, fps = 30, dt = 1 / 30, accuracy = 1e-9 }
scene:particle { position = { 0.1, 0.2, z0 }, velocity = { 0, 0, -v }, mass = 0.01 }
scene:body { shape = "plane", size = 2 }
scene:corrector("contact", { restitution = 1, radius = r })
scene:exact(function(t) return 0.1, 0.2, r + math.abs(z0 - r - v * t) end)
return scene
