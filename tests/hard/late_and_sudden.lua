--[[
what: nothing holds a mass for a million seconds, in steps of a thousand; then a spring sets in and rings ten times a
  second
right: closed form: rest, and an oscillation from t = 1e6 s on
must: dopri5, esdirk4, arkode
]]
-- The bound: a hundredth of the amplitude, five periods on. Of t, 1e-10 s are left there, which is 6e-10 m.
local w, late, A = 60, 1e6, 0.1
local scene = hooke.scene { duration = late + 0.5, fps = 1e-3, tol = 1e-8, accuracy = 1e-3 }

scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:particle { position = { 1 + A, 0, 0 }, mass = 1 }
scene:pin { 1 }
scene:force("springs", { edges = { { 1, 2 } }, k = w * w, rest = 1, from = late })

scene:exact(function(t) return 0, 0, 0, 1 + A * math.cos(w * math.max(0, t - late)), 0, 0 end)
return scene
