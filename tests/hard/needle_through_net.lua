--[[
what: the two ends of a needle fly at 30 m/s through a mesh of a pinned net, a tenth of a millimetre beside a thread
right: closed form: it touches nothing
must: leapfrog, rk4, symplectic_euler
]]
-- The bound: paths are straight: rounding.
local v, r, cell = 30, 5e-4, 0.02
local scene = hooke.scene { duration = 0.1, fps = 30, accuracy = 1e-9 }
local x = -cell / 2 + 2 * r + 1e-4
local needle = {}
for k = 0, 1 do
  needle[k + 1] = scene:particle { position = { x, 0.003, 0.4 + 0.1 * k }, velocity = { 0, 0, -v }, mass = 0.01 }
end
for side = -1, 1, 2 do
  for along = 1, 2 do
    local from, to = { -cell, -cell, 0 }, { cell, cell, 0 }
    from[along], to[along] = side * cell / 2, side * cell / 2
    scene:pin(scene:strand { n = 3, from = from, to = to, mass = 0.01 })
  end
end
scene:force("springs", { edges = { needle }, k = 1 })
scene:corrector("contact", { restitution = 1, radius = r })
scene:exact(function(t) return x, 0.003, 0.4 - v * t, x, 0.003, 0.5 - v * t end)
return scene
