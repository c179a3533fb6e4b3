-- sine.lua: a particle drifts along x while a force pulls it to the line y = 0: its path is a sine wave.
local k = param("k", 4, "pull, 1/s^2", { min = 0 })

local scene = hooke.scene { duration = 10, fps = 30, integrator = "leapfrog", dt = 1 / 240 }

local p = scene:particle { position = { 0, -2, 0 }, velocity = { 1, 0, 0 }, mass = 1 }
scene:force("central", { center = { 0, 0, 0 }, axis = { 1, 0, 0 }, strength = k, power = 1 })

scene:exact(function(t) return t, -2 * math.cos(math.sqrt(k) * t), 0 end)
scene:measure("y", function(s) return s:position(p)[2] end, { unit = "m" })
scene:output("table")
return scene
