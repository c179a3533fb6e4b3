--[[
what: a pin shakes a damped spring at its own frequency and pumps energy in, a hundred times what there was; all as it
  should be
right: closed form, linear response: transfer function and transient
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid,
  tr_bdf2, esdirk4
]]
-- The bound: leapfrog at h = 1/240 s lags by (h w)^2/24 w T = 6e-3 of a swing of 0.04 m; four times that.
local w, damping, A = 20, 0.02, 0.005 -- damping: as a part of the critical
local scene = hooke.scene { duration = 1, fps = 240, tol = 1e-8, accuracy = 1e-3 }

local pivot = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local mass = scene:particle { position = { 1, 0, 0 }, mass = 0.5 }
scene:pin({ pivot }, { path = function(t) return A * math.sin(w * t), 0, 0, A * w * math.cos(w * t), 0, 0 end })
scene:force("springs", { edges = { { pivot, mass } }, k = 0.5 * w * w, damping = damping * w, rest = 1 })

-- x'' + 2 z w x' + w^2 x = w^2 p + 2 z w p' is solved by x = A (sin w t - cos w t/(2 z)); the transient cancels it at
-- 0.
scene:exact(function(t)
  local z, v = damping, w * math.sqrt(1 - damping ^ 2)
  local steady, x0, v0 = A * (math.sin(w * t) - math.cos(w * t) / (2 * z)), A / (2 * z), -A * w
  local transient = math.exp(-z * w * t) * (x0 * math.cos(v * t) + (v0 + z * w * x0) / v * math.sin(v * t))
  return A * math.sin(w * t), 0, 0, 1 + steady + transient, 0, 0
end)
return scene
