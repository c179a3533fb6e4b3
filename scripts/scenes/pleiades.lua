-- pleiades.lua: seven bodies in a plane, of masses 1 to 7, with some close encounters: a test problem for integrators
-- (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.10). At t = 3 the first is at
-- (0.37061391439705129, -3.9434375855173921).
local T = param("duration", 3, "s", { min = 0.01 })
local x, y = { 3, 3, -1, -3, 2, -2, 2 }, { 3, -3, 2, 0, 0, -4, 4 }
local vx, vy = { 0, 0, 0, 0, 0, 1.75, -1.5 }, { 0, 0, 0, -1.25, 1, 0, 0 }

local scene = hooke.scene { duration = T, fps = 60, integrator = "dop853", tol = 1e-11 }

local ids = {}
for i = 1, 7 do
  ids[i] = scene:particle { position = { x[i], y[i], 0 }, velocity = { vx[i], vy[i], 0 }, mass = i }
end
scene:force("nbody", { G = 1 })

scene:measure("x", function(s) return s:position(ids[1])[1] end)
scene:measure("y", function(s) return s:position(ids[1])[2] end)
scene:measure("energy", function(s) return s:energy() end)
scene:output("frames", { width = 800, height = 800, color = "speed", range = { 0, 6 }, radius = 0.16,
  from = { 0, 0, 16 }, look_at = { 0, 0.4, 0 }, ground = false, background = { 0.02, 0.02, 0.05 } })
return scene
