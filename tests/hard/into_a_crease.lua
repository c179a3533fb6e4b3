--[[
what: a particle falls into a crease of 90 degrees of a pinned sheet and bounces off both of its sides
right: closed form: down, across, and up again
must: leapfrog, rk4, symplectic_euler
]]
-- The bound: paths are straight: rounding.
local v, r, a, z0 = 2, 1e-3, 0.1, 0.5
local scene = hooke.scene { duration = 0.6, fps = 20, accuracy = 1e-9 }
scene:particle { position = { -a, 0, z0 }, velocity = { 0, 0, -v }, mass = 0.1 }
local sheet = scene:mesh { mass = 1, faces = { { 1, 2, 3, 4 }, { 4, 3, 5, 6 } },
  vertices = { { -1, -1, 1 }, { -1, 1.1, 1 }, { 0, 1, 0 }, { 0, -1, 0 }, { 1, 1.2, 1 }, { 1, -1, 1 } } }
scene:pin(sheet)
scene:corrector("contact", { restitution = 1, thickness = 1e-3, body_thickness = 1e-3, radius = r })
scene:exact(function(t)
  local low = a + math.sqrt(2) * (r + 5e-4) -- m, the height of the way across
  local way = v * t
  local down, across = z0 - low, 2 * a
  if way < down then return -a, 0, z0 - way end
  if way < down + across then return -a + way - down, 0, low end
  return a, 0, low + way - down - across
end)
return scene
