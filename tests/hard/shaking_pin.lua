--[[
what: a pin shakes four whole times in a frame, so that every step of a frame, and of half a frame, finds it where it
  was
right: closed form, linear response: the mass swings about the middle of the shaking, 0.1 m off the start
must: dopri5, esdirk4, arkode
also: leapfrog dt=1/120; rk4 dt=1/240; stoermer dt=1/240; bdf2 dt=1/240; implicit_midpoint dt=1/240
]]
-- The bound: a tenth of the 0.2 m that the mass moves. dopri5 looks inside its step and sees the pin move.
local w, W, A = 5, 2 * math.pi * 240, 0.1
local scene = hooke.scene { duration = 0.5, fps = 60, tol = 1e-9, accuracy = 0.02 }

local pivot = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local mass = scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:pin({ pivot }, { path = function(t) return A * (1 - math.cos(W * t)), 0, 0, A * W * math.sin(W * t), 0, 0 end })
scene:force("springs", { edges = { { pivot, mass } }, k = w * w, rest = 0 })

scene:exact(function(t)
  local r = w * w / (w * w - W * W)
  return A * (1 - math.cos(W * t)), 0, 0, A * (1 - math.cos(w * t) - r * (math.cos(W * t) - math.cos(w * t))), 0, 0
end)
return scene
