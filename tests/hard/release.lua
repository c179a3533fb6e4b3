--[[
what: the upper of two masses on a swinging spring is let go in the middle of a step; the fall is free, the spring
  rings on
right: closed form in pieces: an oscillation about m2 g/k, then the centre falls and the masses ring about it
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2
]]
-- The bound: bdf2 at h = 1e-3 s lags by (h w)^2/3 w T = 4e-3 of 0.1 m; twice that.
local m1, m2, k, L, g, s0, let_go = 1, 2, 400, 1, 9.81, 0.15, 0.3137
local scene = hooke.scene { duration = 1, fps = 500, tol = 1e-8, accuracy = 1e-3 }

local upper = scene:particle { position = { 0, 0, 0 }, mass = m1 }
local lower = scene:particle { position = { 0, 0, -L - s0 }, mass = m2 }
scene:pin({ upper }, { release = let_go })
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = { { upper, lower } }, k = k, rest = L })

local function hanging(t) -- the stretch and its rate
  local w, mean = math.sqrt(k / m2), m2 * g / k
  return mean + (s0 - mean) * math.cos(w * t), -(s0 - mean) * w * math.sin(w * t)
end
scene:exact(function(t)
  if t <= let_go then return 0, 0, 0, 0, 0, -L - hanging(t) end
  local s, rate = hanging(let_go)
  local part, w, u = m2 / (m1 + m2), math.sqrt(k / m1 + k / m2), t - let_go
  local stretch = s * math.cos(w * u) + rate / w * math.sin(w * u)
  local centre = -part * (L + s + rate * u) - g * u * u / 2
  return 0, 0, centre + part * (L + stretch), 0, 0, centre - (1 - part) * (L + stretch)
end)
return scene
