local scene = hooke.scene { duration = 2, fps = 10 }
scene:source("emitter", { rate_of_time = function(t) return 50 * (1 + math.sin(math.pi * t)) end, lifetime = 0.5 })
scene:force("gravity")
scene:measure("n", function(s) return s.n end)
return scene
