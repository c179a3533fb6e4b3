--[[
what: a charge under its weight drifts sideways across a magnetic field and neither falls nor gains energy
right: closed form, a cycloid: drift m g/(q B) and a gyration about it
must: leapfrog, stoermer5, rk4, dopri5, implicit_midpoint, tr_bdf2, esdirk4
]]
-- The bound: leapfrog turns too fast by 5/12 (h w)^2 w T = 7e-3 rad at h = 1/1000 s, of a radius of 0.025 m, and
-- drifts at the right pace; four times that.
local g, w = 10, 20
local scene = hooke.scene { duration = 2, fps = 1000, tol = 1e-8, accuracy = 7e-4 }

scene:particle { position = { 0, 0, 0 }, mass = 5 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("magnetic", { B = { 0, 0.5, 0 }, ratio = w / 0.5 })

scene:exact(function(t) -- x'' = -w z', z'' = w x' - g, from rest
  return g / w * t - g / w ^ 2 * math.sin(w * t), 0, g / w ^ 2 * (math.cos(w * t) - 1)
end)
return scene
