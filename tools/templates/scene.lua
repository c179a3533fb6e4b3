-- NAME: a rope hangs from its first particle and swings. hooke run NAME.lua; hooke run NAME.lua N=60 k=1e5
local N = param("N", 30, "particles", { min = 2 })
local k = param("k", 1e4, "stiffness of a spring, N/m", { min = 0 })
local damping = param("damping", 0.05, "damping of a spring, N s/m", { min = 0 })

local scene = hooke.scene { duration = 2, fps = 60 }
local rope = scene:strand { n = N, from = { 0, 0, 1 }, to = { 1, 0, 1 }, mass = 0.1 }
scene:pin { 1 }
scene:force("gravity")
scene:force("springs", { edges = rope:edges(), k = k, damping = damping })

scene:measure("height", function(state) return state:position(N)[3] end, { unit = "m" }) -- of the free end: out/NAME/measures.csv
-- scene:output("frames", { width = 1280, height = 720 }) -- pictures and a film: hooke plugins frames
return scene
