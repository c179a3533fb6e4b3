--[[
what: a spinning rod is pushed along itself; the force turns with it, has no energy and an unsymmetric Jacobian
right: closed form: the rod spins on, for both ends get the same push, and its centre runs on a circle
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4
]]
-- The bound: bdf2 at h = 1/2000 s lags by (h w)^2/3 w T = 7e-4 rad at 0.5 m; fifteen times that.
local w, l, m, f = 20, 1, 2, 40
local scene = hooke.scene { duration = 1, fps = 1000, tol = 1e-8, accuracy = 5e-3 }

for side = -1, 1, 2 do
  scene:particle { position = { side * l / 2, 0, 0 }, velocity = { 0, side * w * l / 2, 0 }, mass = m }
end
scene:force("springs", { edges = { { 1, 2 } }, k = 1e4, rest = l - m * w * w * l / 2 / 1e4 })
scene:force("follower", { edges = { { 1, 2 } }, f = f, on = "both" })

scene:exact(function(t)
  local a, c, s = f / (2 * m), math.cos(w * t), math.sin(w * t)
  local x, y = a / w ^ 2 * (1 - c), a / w * (t - s / w)
  return x - l / 2 * c, y - l / 2 * s, 0, x + l / 2 * c, y + l / 2 * s, 0
end)
return scene
