--[[
what: particles are born between steps, less than one in a step: each method has to take up what is born amid its step
right: closed form, an oscillation of each from its own beginning
must: leapfrog, stoermer, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2,
  esdirk4
]]
-- The bound: as in births.lua, where births are at the ends of frames; bdf2 lags by 1.1e-3 of 0.5 m.
local w, A, rate, from = 30, 0.5, 8.7, 0.01234
local scene = hooke.scene { duration = 0.475, fps = 1000, tol = 1e-8, accuracy = 2e-3 }

scene:particle { position = { A, 0, 0 }, mass = 1 }
scene:force("central", { strength = w * w, power = 1 })
scene:source("emitter", { rate = rate, from = from, position = { A, 0, 0 }, speed = 0, mass = 0.1 })

scene:exact(function(t)
  local x = { { A * math.cos(w * t), 0, 0 } }
  for k = 0, math.floor((t - from) * rate) do x[k + 2] = { A * math.cos(w * (t - from - k / rate)), 0, 0 } end
  return x
end)
return scene
