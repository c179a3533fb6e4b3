--[[
what: a push of 1 ms within a frame, and a drag that sets in later: short and hard, but given by from and to
right: closed form: rest, a parabola, a straight line, an exponential
must: leapfrog, stoermer, stoermer5, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, tr_bdf2, esdirk4
]]
-- The bound: steps end at the events, so there is the error of the drag alone, at most (h rate)^2/12 of v/rate = 3.3 m,
-- 7e-4 m at h = 1/60 s; four times that.
local push, from, to, brake, rate = 1e4, 0.2071, 0.2081, 0.4519, 3
local scene = hooke.scene { duration = 1, fps = 60, tol = 1e-8, accuracy = 3e-3 }

scene:particle { position = { 0, 0, 0 }, mass = 0.7 }
scene:force("gravity", { g = { push, 0, 0 }, from = from, to = to })
scene:force("drag", { rate = rate, from = brake })

scene:exact(function(t)
  local v, x = push * (to - from), push * (to - from) ^ 2 / 2
  if t < from then return 0, 0, 0 end
  if t < to then return push * (t - from) ^ 2 / 2, 0, 0 end
  if t < brake then return x + v * (t - to), 0, 0 end
  return x + v * (brake - to) + v * (1 - math.exp(-rate * (t - brake))) / rate, 0, 0
end)
return scene
