--[[
what: a rod on a path crosses a resting one at a right angle and meets it at 20 m/s, a metre a step
right: closed form: the free one flies ahead, at twice the speed of the other
must: leapfrog, rk4, symplectic_euler
]]
-- The bound: paths are straight: rounding.
local L = 1
local v, r = 20 * L, 1e-3 * L
local scene = hooke.scene { duration = 0.1, fps = 20, accuracy = 1e-8 * L }
local free = scene:strand { n = 2, from = { -0.3 * L, 0, 0 }, to = { 0.3 * L, 0, 0 }, mass = 0.2 }
local pushed = scene:strand { n = 2, from = { 0, -0.3 * L, -0.5 * L }, to = { 0, 0.3 * L, -0.5 * L }, mass = 0.2 }
scene:pin(pushed:ids(), { path = function(t) return 0, 0, v * t, 0, 0, v end })
scene:force("springs", { edges = free:edges(), k = 10 })
scene:corrector("contact", { restitution = 1, thickness = 2 * r, radius = r })
scene:exact(function(t)
  local z = math.max(0, 2 * (v * t - 0.5 * L + 2 * r))
  return -0.3 * L, 0, z, 0.3 * L, 0, z
end)
return scene
