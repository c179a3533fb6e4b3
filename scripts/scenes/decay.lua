-- decay.lua: an amount that decays, dy/dt = -k y. Explicit Euler follows it for h <= 1/k, oscillates about zero
-- beyond, and explodes beyond h = 2/k: try --integrator euler --dt 0.05, 0.15 and 0.25 (frames are 0.25 s apart).
local k = param("k", 10, "decay rate, 1/s", { min = 0 })

local scene = hooke.scene { duration = 5, fps = 4, integrator = "euler" }

local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:channel("amount", { initial = 1, rate = -k })
scene:pin { p }

scene:measure("y", function(s) return s:channel("amount", p) end)
scene:measure("exact", function(s) return math.exp(-k * s.t) end)
return scene
