--[[
what: a chain folded three times onto one bar turns about its pin; joints lie in one place
right: closed form, it turns uniformly, and the joint on the pin stays
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, midpoint, implicit_midpoint, bdf2, esdirk4
]]
-- No force opens the fold and none closes it: the inner bars bear nothing. The bound: leapfrog's (h w)^2/24 w T = 2e-4
-- rad at h = 1/200 s, of both outer joints, times five for what the fold opens by.
local w = 5
local scene = hooke.scene { duration = 2, fps = 200, accuracy = 5e-3 }
scene:particles {
  positions = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 } },
  velocities = { { 0, 0, 0 }, { 0, w, 0 }, { 0, 0, 0 }, { 0, w, 0 } }, mass = 1,
}
scene:pin { 1 }
scene:constraint("bars", { edges = { { 1, 2 }, { 2, 3 }, { 3, 4 } } })
scene:exact(function(t)
  local x, y = math.cos(w * t), math.sin(w * t)
  return 0, 0, 0, x, y, 0, 0, 0, 0, x, y, 0
end)
return scene
