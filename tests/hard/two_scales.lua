--[[
what: an oscillator of 0.6 s beside one of 6e-4 s that has a thousandth of its amplitude and ten times its energy
right: closed form, two springs apart
must: dopri5, stoermer5, tr_bdf2, esdirk4
]]
-- The bound: the fast one, at 1e-4 m, may be anywhere; 1e-3 m is for the slow one. Who loses the energy may say so.
local w, A = { 10, 1e4 }, { 0.1, 1e-4 }
local scene = hooke.scene { duration = 0.1, fps = 240, tol = 1e-4, accuracy = 1e-3 }

for k = 1, 2 do
  scene:particle { position = { 0, k, 0 }, mass = 1 }
  scene:particle { position = { 1 + A[k], k, 0 }, mass = 1 }
end
scene:pin { 1, 3 }
scene:force("springs", { edges = { { 1, 2 }, { 3, 4 } }, k = { w[1] ^ 2, w[2] ^ 2 }, rest = 1 })

scene:exact(function(t)
  return 0, 1, 0, 1 + A[1] * math.cos(w[1] * t), 1, 0, 0, 2, 0, 1 + A[2] * math.cos(w[2] * t), 2, 0
end)
return scene
