--[[
what: a force of one size that turns over where the particle crosses a plane: a field that jumps in space
right: closed form, parabolas in pieces, all of one period
must: leapfrog, rk4, dopri5, implicit_midpoint, bdf2
]]
-- The bound: a step of h = 1/1000 s across the jump of 2 a misses up to 2 a h = 0.04 m/s for some part of it, six times in
-- 2 s: up to 0.04 m/s for a second each, of which signs cancel two by two.
local scene = hooke.scene { duration = 2, fps = 1000, tol = 1e-6, accuracy = 0.08 }
local a, start = 20, 0.25 -- m/s^2, m

scene:particle { position = { start, 0, 0 }, mass = 3 }
scene:force("field", { f = function(_, x) return x < 0 and 3 * a or -3 * a, 0, 0 end })

scene:exact(function(t)
  local quarter = math.sqrt(2 * start / a)
  local phase = t / quarter % 4
  local side = (phase < 1 or phase >= 3) and 1 or -1
  local s = (phase < 2 and phase or phase - 4) -- time from a turning point, in quarters
  if phase >= 1 and phase < 3 then s = phase - 2 end
  return side * (start - a * (s * quarter) ^ 2 / 2), 0, 0
end)
return scene
