--[[
what: two masses spin 16 times a second about each other, their spring pulled to twice its length
right: closed form, m w^2 l/2 = k (l - L)
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, dopri5, esdirk4, implicit_midpoint, implicit_trapezoid, bdf2
]]
-- The bound: bdf2 at h = 1/8000 s lags by (h w)^2/3 w T = 1.3e-3 of 0.1 m, leapfrog by half of that; six times that.
local w, l, m = 100, 0.2, 1
local scene = hooke.scene { duration = 0.25, fps = 4000, tol = 1e-8, accuracy = 8e-4 }

for side = -1, 1, 2 do
  scene:particle { position = { 1 + side * l / 2, 2, 0 }, velocity = { 0, side * w * l / 2, 0 }, mass = m }
end
scene:force("springs", { edges = { { 1, 2 } }, k = m * w * w, rest = l / 2 })

scene:exact(function(t)
  local x, y = l / 2 * math.cos(w * t), l / 2 * math.sin(w * t)
  return 1 - x, 2 - y, 0, 1 + x, 2 + y, 0
end)
return scene
