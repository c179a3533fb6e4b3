--[[
what: a bead of a thousandth of the mass rings on a spring that lets go: the ring has next to no energy, and decides
  where the bead flies
right: closed form in pieces: the centre falls, the spring rings about it, then both fly freely
must: stoermer5, blanes_moan, dopri5, esdirk4, arkode
also: backward_euler dt=5e-4; local_global dt=2e-4; implicit_midpoint dt=1e-4; bdf2 dt=1e-4
]]
-- The bound: a fifteenth of the 0.8 m that ringing carries the bead after the spring let go, at cos(w 0.4588) of 3 m/s.
local m, k, L, u, g, let_go = { 1e-4, 0.1 }, 20, 1, 3, 9.81, 0.4588
local scene = hooke.scene { duration = 1, fps = 1000, tol = 1e-8, accuracy = 0.05 }

scene:particle { position = { 0, 0, 0 }, velocity = { u, 0, 0 }, mass = m[1] }
scene:particle { position = { L, 0, 0 }, mass = m[2] }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = { { 1, 2 } }, k = k, rest = L, to = let_go })

scene:exact(function(t)
  local w, total, ringing = math.sqrt(k / m[1] + k / m[2]), m[1] + m[2], math.min(t, let_go)
  local length = L - u / w * math.sin(w * ringing) - u * math.cos(w * ringing) * (t - ringing)
  local centre, z = (m[2] * L + m[1] * u * t) / total, -g * t * t / 2
  return centre - m[2] / total * length, 0, z, centre + m[1] / total * length, 0, z
end)
return scene
