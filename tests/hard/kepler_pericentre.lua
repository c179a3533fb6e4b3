--[[
what: a Kepler orbit of eccentricity 0.99 from the pericentre, where a step must be 1e-3 of what does at the far end
right: closed form, Kepler's equation
must: dopri5, esdirk4
also: leapfrog dt=7e-4; rk4 dt=1e-3; implicit_midpoint dt=2e-3; bdf2 dt=2e-3
]]
-- The bound: a thousandth of the orbit's great half axis.
local e = 0.99
local scene = hooke.scene { duration = 2 * math.pi, fps = 60, tol = 1e-10, accuracy = 1e-3 }

scene:particle { position = { 1 - e, 0, 0 }, velocity = { 0, math.sqrt((1 + e) / (1 - e)), 0 }, mass = 1 }
scene:force("central", { strength = 1, power = -2 })

scene:exact(function(t) -- E - e sin E = M by bisection, which cannot fail however steep
  local M = t % (2 * math.pi)
  local low, high = 0, 2 * math.pi
  for _ = 1, 60 do
    local E = (low + high) / 2
    if E - e * math.sin(E) < M then low = E else high = E end
  end
  local E = (low + high) / 2
  return math.cos(E) - e, math.sqrt(1 - e * e) * math.sin(E), 0
end)
return scene
