--[[
what: a swing of a day is followed for twelve of them, in steps of minutes up to t = 1e6 s; its pin moves by a
  function of t
right: closed form, linear response: the spring has no rest length
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid,
  tr_bdf2, esdirk4
]]
-- The bound: leapfrog at h = 1000 s lags by (h w)^2/24 w T = 0.016 of 0.9 m; twice that.
local w, W, A = 2 * math.pi / 86400, 2 * math.pi / 50000, 1
local scene = hooke.scene { duration = 1e6, fps = 1e-3, tol = 1e-6, accuracy = 0.03 }

local pivot = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local mass = scene:particle { position = { 0, 0, 0 }, mass = 5 }
scene:pin({ pivot }, { path = function(t) return A * math.sin(W * t), 0, 0 end })
scene:force("springs", { edges = { { pivot, mass } }, k = 5 * w * w, rest = 0 })

scene:exact(function(t)
  local r = A * w * w / (w * w - W * W)
  return A * math.sin(W * t), 0, 0, r * (math.sin(W * t) - W / w * math.sin(w * t)), 0, 0
end)
return scene
