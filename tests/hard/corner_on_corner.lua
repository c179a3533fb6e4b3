--[[
what: a particle meets the corner of a triangle head on: the nearest point is the end of two edges and of the triangle
right: closed form: the particle and the corner, of equal mass, change their speeds; the other corners rest
must: leapfrog, rk4, symplectic_euler
]]
-- The bound: paths are straight: rounding.
local v, h, r = 1, 1e-3, 5e-4
local scene = hooke.scene { duration = 0.5, fps = 50, accuracy = 1e-9 }
local place = { { 0.1, 0, 0 }, { 0.6, 0.2, 0.1 }, { 0.6, -0.2, 0.1 } }
scene:mesh { vertices = place, faces = { { 1, 2, 3 } }, mass = 0.3 }
scene:particle { position = { -0.1, 0, 0 }, velocity = { v, 0, 0 }, mass = 0.1 }
scene:corrector("contact", { restitution = 1, thickness = h, radius = r })
scene:exact(function(t)
  local stop = 0.1 - h / 2 - r -- m, where the particle is when it touches
  local after = math.max(0, t - (stop + 0.1) / v)
  return { 0.1 + v * after, 0, 0, 0.6, 0.2, 0.1, 0.6, -0.2, 0.1, math.min(-0.1 + v * t, stop), 0, 0 }
end)
return scene
