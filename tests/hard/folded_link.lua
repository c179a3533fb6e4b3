--[[
what: a rigid link on an angle spring swings through being straight, where its plane is unknown, to 0.04 rad from folded
right: closed form, the angle is harmonic at any amplitude, with sqrt(k/(m l^2))
must: leapfrog, rk4, dopri5, implicit_midpoint, esdirk4, tr_bdf2
]]
-- The bound: leapfrog is off by 2.1e-3 m with h = 1/100 s, and by 5.2e-4 with half of it; four times the first.
local amplitude = 3.1
local scene = hooke.scene { duration = 20, fps = 100, tol = 1e-8, accuracy = 8e-3 }

local wall = scene:particles { positions = { { -1, 0, 0 }, { 0, 0, 0 } }, mass = 1 }
local link = scene:particle { position = { math.cos(amplitude), 0, math.sin(amplitude) }, mass = 1 }
scene:pin(wall)
scene:force("angle_springs", { joints = { { wall:at(1), wall:at(2), link } }, k = 1, rest = 0 })
scene:constraint("bars", { edges = { { wall:at(2), link } } })

scene:exact(function(t)
  local angle = amplitude * math.cos(t)
  return -1, 0, 0, 0, 0, 0, math.cos(angle), 0, math.sin(angle)
end)
return scene
