--[[
what: stones fly straight on, seen from a frame that turns: Coriolis and centrifugal forces a hundred times the motion
right: closed form, a straight line turned back
must: rk4, dopri5, tr_bdf2, esdirk4, stoermer5
]]
-- The bound: a thousandth of the 2 m that the stones end away from the axis.
local W = 2 * math.pi
local scene = hooke.scene { duration = 1.7, fps = 500, tol = 1e-9, accuracy = 2e-3 }
-- In the resting frame.
local stones = { { x = { 1, 0, 0 }, v = { 1, 0.5, 0 } }, { x = { 0, -1, 2 }, v = { -0.3, 0.2, -1 } } }

for k, s in ipairs(stones) do
  scene:particle { position = s.x, velocity = { s.v[1] + W * s.x[2], s.v[2] - W * s.x[1], s.v[3] }, mass = k }
end
scene:force("magnetic", { B = { 0, 0, 2 * W }, ratio = 1 })
scene:force("central", { axis = { 0, 0, 1 }, strength = -W ^ 2, power = 1 })

scene:exact(function(t)
  local at, c, s = {}, math.cos(W * t), math.sin(W * t)
  for k, p in ipairs(stones) do
    local x, y = p.x[1] + p.v[1] * t, p.x[2] + p.v[2] * t
    at[k] = { c * x + s * y, c * y - s * x, p.x[3] + p.v[3] * t }
  end
  return at
end)
return scene
