--[[
what: a pin is snatched 0.1 m aside within 5 ms, at 20 m/s, and stops dead
right: closed form: x'' = w^2 (p - x) with p a ramp from `start` to `stop`: the spring has no rest length
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, dopri5, implicit_midpoint, bdf2, tr_bdf2
]]
-- The bound: a step of h across a corner of the path errs by w^2 V h^2/12 = 2e-4 m/s in velocity, for 0.5 s; five times
-- that.
local w, V, start, stop = 10, 20, 0.50371, 0.50871
local scene = hooke.scene { duration = 1, fps = 1000, tol = 1e-6, accuracy = 5e-4 }

local pivot = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local mass = scene:particle { position = { 0, 0, 0 }, mass = 1 }
local function along(t) return V * (math.max(0, t - start) - math.max(0, t - stop)) end
scene:pin({ pivot }, { path = function(t) return along(t), 0, 0, t >= start and t < stop and V or 0, 0, 0 end })
scene:force("springs", { edges = { { pivot, mass } }, k = w * w, rest = 0 })

local function answer(t) return t > 0 and V * (t - math.sin(w * t) / w) or 0 end -- to a ramp that never ends
scene:exact(function(t) return along(t), 0, 0, answer(t - start) - answer(t - stop), 0, 0 end)
return scene
