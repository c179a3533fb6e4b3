--[[
what: an oscillator of 0.6 s beside one of 6e-3 s, and the fast one is asked for as well
right: closed form, two springs apart
must: rk4, dopri5, stoermer5
]]
-- The bound: a tenth of the fast one's amplitude after 16 of its periods.
local w, A = { 10, 1000 }, { 0.1, 0.01 }
local scene = hooke.scene { duration = 0.1, fps = 5000, tol = 1e-8, accuracy = 1e-3 }

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
