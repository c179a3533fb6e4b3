--[[
what: two sheets in one place: they touch everywhere, and nothing says which one is to be above
right: nobody can; a run must not be content with it
must: none
]]
-- The bound: what the first sheet does if it rests, as it would above a second one.
local scene = hooke.scene { duration = 0.1, fps = 50, accuracy = 1e-6 }
local a = scene:grid { nx = 3, ny = 3, mass = 0.1 }
local b = scene:grid { nx = 3, ny = 3, mass = 0.1 }
scene:force("springs", { edges = a:structural() .. b:structural(), k = 10 })
scene:corrector("contact")
scene:corrector("untangle")
scene:exact(function() return 0, 0, 1e-3 end)
return scene
