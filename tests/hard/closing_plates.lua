--[[
what: a ball between two plates that close on it, down to a twentieth of their distance: every bounce makes it faster, some 20
  in all, the last ones several in a step
right: closed form in pieces: in elastic bounces off a plate of speed V the ball's speed rises by 2 V
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4, imex, symplectic_euler, euler
]]
-- The bound: without forces paths are straight, and plates of constant speed are where they should be: rounding, which bounces
-- amplify as speeds grow, by 20.
local L, V, v = 0.5, 0.475, 1 -- m, half of the distance; m/s
local scene = hooke.scene { duration = 1, fps = 50, dt = 0.02, tol = 1e-8, accuracy = 1e-8 }

scene:particle { position = { 0, 0, 0.1 }, velocity = { 0, 0, v }, mass = 1 }
scene:corrector("obstacle", { label = "below", normal = { 0, 0, 1 }, restitution = 1,
  position = function(t) return 0, 0, -L + V * t end })
scene:corrector("obstacle", { label = "above", normal = { 0, 0, -1 }, restitution = 1,
  position = function(t) return 0, 0, L - V * t end })

scene:exact(function(t)
  local z, w, s = 0.1, v, 0
  while true do -- to the plate ahead
    local side = w > 0 and 1 or -1
    local dt = (L - V * s - side * z) / (math.abs(w) + V)
    if s + dt >= t then return 0, 0, z + w * (t - s) end
    z, s, w = z + w * dt, s + dt, -w - side * 2 * V
  end
end)
return scene
