-- NAME.lua: one particle of 1 kg starts at rest and is carried by the wind: v = wind (1 - exp(-d t / m)). Run it with
-- --trust.
local scene = hooke.scene { duration = 2, fps = 60, integrator = "rk4" }

local d, wind = 0.5, 3
local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:force("./NAME.so", { wind = { wind, 0, 0 }, d = d })

scene:exact(function(t) return wind * (t - (1 - math.exp(-d * t)) / d), 0, 0 end)
scene:measure("speed", function(s) return s:velocity(p)[1] end)
return scene
