--[[
what: two masses fall on one slack chain, whose links come taut one after the other, and stop dead
right: closed form: free fall, inelastic impacts along the chain, rest
must: leapfrog, stoermer, rk4, dopri5, bdf2
also: leapfrog dt=1/60; rk4 dt=1/60; dopri5 tol=1e-6; symplectic_euler dt=1e-2; bdf2 dt=1/60
]]
-- The bound: some percent of a link. The lower mass falls on when the upper one has stopped; a step too long passes both.
local g, limit = 10, 0.55
local scene = hooke.scene { duration = 0.8, fps = 50, tol = 1e-8, accuracy = 0.01 }

local pin = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local upper = scene:particle { position = { 0, 0, -0.1 }, mass = 0.1 }
local lower = scene:particle { position = { 0, 0, -0.2 }, mass = 5 }
scene:pin { pin }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("strain_limit", { edges = { { pin, upper }, { upper, lower } }, rest = 0.5, limit = 0.1 })

scene:exact(function(t)
  local way = g * t * t / 2
  return 0, 0, 0, 0, 0, math.max(-limit, -0.1 - way), 0, 0, math.max(-2 * limit, -0.2 - way)
end)
return scene
