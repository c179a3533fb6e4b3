--[[
what: a pressed strut, off by a micrometre, buckles at a rate of 632 1/s, which long steps cannot follow
right: closed form, it comes to rest where its springs have their length
must: leapfrog, stoermer, rk4, dopri5, arkode
also: backward_euler dt=1/60; bdf2 dt=1/60; tr_bdf2 dt=1/60; esdirk4 dt=1/60; implicit_midpoint dt=1/60
]]
-- The bound: a thousandth of the deflection of 0.66 m. Of the swing, exp(-75 t) x 0.4 m = 1e-7 m is left.
local scene = hooke.scene { duration = 0.2, accuracy = 1e-3, accuracy_at = "end" }
local k, L = 1e6, 1.2 -- N/m, m; 1 kg

scene:particles { positions = { { -1, 0, 0 }, { 0, 1e-6, 0 }, { 1, 0, 0 } }, mass = 1 }
scene:pin { 1, 3 }
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = k, rest = L })
scene:force("drag", { rate = 150 })

scene:exact(function(t)
  if t == 0.2 then return -1, 0, 0, 0, math.sqrt(L * L - 1), 0, 1, 0, 0 end
end)
return scene
