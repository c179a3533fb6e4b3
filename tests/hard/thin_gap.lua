--[[
what: a particle between two plates a millimetre apart bounces up to 25 times in a frame
right: closed form: a triangular wave in time
must: leapfrog, stoermer, rk4, symplectic_euler
]]
-- The bound: a quarter of the way that the particle can go: a lost bounce is beyond it.
local v, gap, r = 1, 1e-3, 1e-4
local free = gap - 2 * r
local scene = hooke.scene { duration = 0.2, fps = 50, accuracy = free / 4 }
scene:particle { position = { 0.1, 0.2, gap / 2 }, velocity = { 0, 0, -v }, mass = 0.01 }
scene:body { shape = "plane", size = 1 }
scene:body { shape = "plane", size = 1, position = { 0, 0, gap }, orientation = { math.pi, 0, 0 } }
scene:corrector("contact", { restitution = 1, radius = r })
scene:exact(function(t)
  local way = (v * t + free / 2) % (2 * free)
  return 0.1, 0.2, r + math.abs(free - way)
end)
return scene
