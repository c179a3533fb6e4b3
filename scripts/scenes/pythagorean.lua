-- pythagorean.lua: three bodies of masses 3, 4 and 5 at rest in the corners of a right triangle, each opposite the side
-- of its length (Burrau 1913). They fall, pass each other closely again and again, and at last the lightest is thrown
-- out (Szebehely and Peters 1967). Chaos makes that hard to follow: at t = 10 the first is at (0.7784804101380855,
-- 0.1413923002900862), at t = 70 at (6.933463599011887, 20.26180430595171). Rounding errors grow to 1e-11 and 0.05 of that.
local T = param("duration", 60, "s; the lightest leaves at about 60", { min = 0.1 })
local scene = hooke.scene { duration = T, fps = 30, integrator = "gauss_radau" }

local ids = {}
for i, at in ipairs { { 1, 3, 0 }, { -2, -1, 0 }, { 1, -1, 0 } } do
  ids[i] = scene:particle { position = at, mass = i + 2 }
end
scene:force("nbody", { G = 1 })

scene:measure("energy", function(s) return s:energy() end) -- -769/60
scene:measure("x", function(s) return s:position(ids[1])[1] end)
scene:measure("y", function(s) return s:position(ids[1])[2] end)
scene:output("frames", { width = 800, height = 800, color = "speed", range = { 0, 6 }, radius = 0.12,
  from = { 0, 0, 14 }, look_at = { 0, 0, 0 }, ground = false, background = { 0.02, 0.02, 0.05 } })
return scene
