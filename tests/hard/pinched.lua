--[[
what: two plates close on a particle until they leave a fifth of the room that it takes, and part again
right: by symmetry: it stays in the middle
must: leapfrog, rk4
]]
-- The bound: a tenth of the room.
local r = 5e-3
local scene = hooke.scene { duration = 0.5, fps = 50, accuracy = 2e-4 }
scene:particle { position = { 0.1, 0.2, 0 }, mass = 0.01 }
for side = -1, 1, 2 do
  scene:body { shape = "plane", size = 1, position = { 0, 0, side * 0.05 },
    path = function(t) return 0, 0, -side * 0.049 * math.sin(2 * math.pi * t) ^ 2 end }
end
scene:corrector("contact", { radius = r })
scene:corrector("untangle", { radius = r })
scene:exact(function() return 0.1, 0.2, 0 end)
return scene
