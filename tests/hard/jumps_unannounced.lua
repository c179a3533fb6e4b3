--[[
what: gravity turns over at moments that only its function of time knows, each inside a step
right: closed form, parabolas in pieces
must: leapfrog, rk4, dopri5, implicit_midpoint, bdf2, tr_bdf2, esdirk4
]]
-- The bound: a step of 1e-3 s across a jump of 2 g misses up to 2 g h = 0.02 m/s, for less than a second; there are
-- four.
local g, jumps = 10, { 0.10037, 0.31111, 0.47773, 0.80409 }
local scene = hooke.scene { duration = 1, fps = 1000, tol = 1e-6, accuracy = 0.08 }

local function sign(t)
  local s = -1
  for _, at in ipairs(jumps) do if t >= at then s = -s end end
  return s
end
scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 }, mass = 3 }
scene:force("gravity", { g = function(t) return { 0, 0, sign(t) * g } end })

scene:exact(function(t) -- every jump adds its change of acceleration from then on
  local z, change = -g * t * t / 2, 2 * g
  for _, at in ipairs(jumps) do
    if t >= at then z, change = z + change * (t - at) ^ 2 / 2, -change end
  end
  return t, 0, z
end)
return scene
