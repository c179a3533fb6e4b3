--[[
what: a mass on a spring swings against a wall eight times, with restitution: what pulls it after an impact is not what pulled
  it before
right: closed form in pieces, oscillations from the wall to the wall
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4, imex
also: symplectic_euler; backward_euler; leapfrog dt=1e-4
]]
-- The bound: h^2 w^3 A T/24 = 1.7e-4 m of leapfrog's phase at h = 1/500 s, up to four times that for other methods of order 2.
local w, A, wall, e = 10, 0.5, -0.1, 0.9
local scene = hooke.scene { duration = 4, fps = 500, tol = 1e-9, accuracy = 3e-3 }

scene:particle { position = { A, 0, 0 }, mass = 1 }
scene:force("central", { strength = w * w, power = 1 })
scene:corrector("obstacle", { normal = { 1, 0, 0 }, position = { wall, 0, 0 }, restitution = e })

scene:exact(function(t)
  local amplitude, phase = A, 0 -- x = amplitude cos(w t + phase)
  while true do -- to the next wall, on the way in
    if amplitude <= -wall then return amplitude * math.cos(w * t + phase), 0, 0 end
    local hit = math.acos(wall / amplitude) -- x = wall, moving down
    local dt = (hit - phase) / w
    if t < dt then return amplitude * math.cos(w * t + phase), 0, 0 end
    t = t - dt
    local v = e * w * amplitude * math.sin(hit)
    amplitude, phase = math.sqrt(wall ^ 2 + (v / w) ^ 2), -math.atan(v / w, wall)
  end
end)
return scene
