--[[
what: three stones thrown; nothing in the scene sets a step, so it is a whole frame
right: closed form, a parabola each
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: rounding of coordinates of 20 m is 4e-15 m a step; methods of order 2 have no other error.
local g, scene = 9.81, hooke.scene { duration = 2, fps = 60, tol = 1e-10, accuracy = 1e-8 }
local velocity = { { 10, 0, 10 }, { 0, -3, 0 }, { -1, 2, 20 } }

for k = 1, 3 do scene:particle { position = { k, 0, 0 }, velocity = velocity[k], mass = 10 ^ (k - 2) } end
scene:force("gravity", { g = { 0, 0, -g } })

scene:exact(function(t)
  local x = {}
  for k, v in ipairs(velocity) do x[k] = { k + v[1] * t, v[2] * t, v[3] * t - g * t * t / 2 } end
  return x
end)
return scene
