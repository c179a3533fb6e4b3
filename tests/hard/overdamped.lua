--[[
what: damping ratio 1e4: a thrust is stopped within 50 us, then the mass creeps under its weight
right: closed form, a damped oscillator
must: leapfrog, dopri5, cvode, arkode, tr_bdf2, esdirk4
]]
-- The bound: it creeps by m g/c T = 1.2e-4 m, and the thrust carries it by v m/c = 5e-5 m: a tenth of both. The damping
-- acts within a step of most methods, which so cannot sum its work; some say that of themselves, and are right all the
-- same: they are not in the list above.
local scene = hooke.scene { duration = 0.25, tol = 1e-8, accuracy = 2e-5 }
local k, c, g, v0 = 1, 2e4, 9.81, 1 -- N/m, N s/m, m/s^2, m/s; 1 kg

scene:particles { positions = { { 0, 0, 0 }, { 0, 0, -1 } }, velocities = { { 0, 0, 0 }, { 0, 0, -v0 } }, mass = 1 }
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = { { 1, 2 } }, k = k, damping = c, rest = 1 })

scene:exact(function(t) -- s'' + c s' + k s = g, downwards; its rates without cancellation
  local fast = (c + math.sqrt(c * c - 4 * k)) / 2
  local slow, rest = k / fast, g / k
  local thrust = (v0 - slow * rest) / (fast - slow)
  local s = rest * (1 - math.exp(-slow * t)) + thrust * (math.exp(-slow * t) - math.exp(-fast * t))
  return 0, 0, 0, 0, 0, -1 - s
end)
return scene
