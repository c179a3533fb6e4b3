--[[
what: a mass on a soft spring whose pin circles 80 times a second, 50 times as fast as the mass could follow
right: closed form, linear response: the spring has no rest length
must: stoermer5, rk4, blanes_moan, dopri5, esdirk4, implicit_midpoint, arkode
]]
-- The bound: leapfrog sees a force of 1/W^2 (1 + (h W)^2/12), 2 % too much at h = 1e-3 s; the answer is A w/W = 1e-3 m.
local w, W, A = 10, 500, 0.05
local scene = hooke.scene { duration = 0.5, fps = 1000, tol = 1e-8, accuracy = 5e-5 }

local pivot = scene:particle { position = { A, 0, 0 }, mass = 1 }
local mass = scene:particle { position = { 0, 0, 0 }, mass = 2 }
scene:pin({ pivot }, { path = function(t)
  local c, s = math.cos(W * t), math.sin(W * t)
  return A * (c - 1), A * s, 0, -A * W * s, A * W * c, 0
end })
scene:force("springs", { edges = { { pivot, mass } }, k = 2 * w * w, rest = 0 })

scene:exact(function(t)
  local r = A * w * w / (w * w - W * W)
  return A * math.cos(W * t), A * math.sin(W * t), 0,
    r * (math.cos(W * t) - math.cos(w * t)), r * (math.sin(W * t) - W / w * math.sin(w * t)), 0
end)
return scene
