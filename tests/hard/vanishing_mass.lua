--[[
what: two masses joined through a bead of 1e-9 of theirs, which would ring 10,000 times a second if it were touched
right: closed form: the bead stays where its two springs balance, up to 1e-9; the masses ring about their centre
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, bdf2, tr_bdf2, esdirk4
]]
-- The bound: bdf2 at h = 1/480 s errs by some (h w)^2 of the way of 0.025 m, 2e-7 m; five times that.
local m, bead, k, v, rest = { 1, 2 }, 1e-9, 2, 0.5, 1
local scene = hooke.scene { duration = 0.05, fps = 240, tol = 1e-6, accuracy = 1e-6 }

scene:particle { position = { -rest, 0, 0 }, velocity = { -v, 0, 0 }, mass = m[1] }
scene:particle { position = { 0, 0, 0 }, velocity = { 0, 0, 0 }, mass = bead }
scene:particle { position = { rest, 0, 0 }, velocity = { v, 0, 0 }, mass = m[2] }
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = k, rest = rest })

scene:exact(function(t)
  local w = math.sqrt(k / 2 * (1 / m[1] + 1 / m[2]))
  local drift, length = v * (m[2] - m[1]) / (m[1] + m[2]) * t, 2 * v / w * math.sin(w * t)
  local left = drift - m[2] / (m[1] + m[2]) * length
  local right = drift + m[1] / (m[1] + m[2]) * length
  return left - rest, 0, 0, (left + right) / 2, 0, 0, rest + right, 0, 0
end)
return scene
