--[[
what: a bead of a millionth of its partner's mass rings on it: next to the partner's energy its own is nothing
right: closed form, two bodies about their common centre, which flies
must: dopri5, arkode
also: backward_euler dt=1/100; bdf2 dt=1/100; tr_bdf2 dt=1/100; implicit_midpoint dt=1/100; rk4 dt=1/900
]]
-- The bound: a tenth of the amplitude, spread over two particles.
local scene = hooke.scene { duration = 0.2, fps = 100, tol = 1e-11, accuracy = 5e-4 }
local light, heavy, a, w, V = 1e-6, 1, 0.01, 1000, 50 -- kg, kg, m, 1/s, m/s
local k = w * w * light * heavy / (light + heavy)

scene:particle { position = { 0, 0, 0 }, velocity = { 0, V, 0 }, mass = heavy }
scene:particle { position = { 1 + a, 0, 0 }, velocity = { 0, V, 0 }, mass = light }
scene:force("springs", { edges = { { 1, 2 } }, k = k, rest = 1 })

scene:exact(function(t)
  local centre, l = light * (1 + a) / (light + heavy), 1 + a * math.cos(w * t)
  return centre - l * light / (light + heavy), V * t, 0, centre + l * heavy / (light + heavy), V * t, 0
end)
return scene
