--[[
what: a mass falls into a rope, is thrown up again and flies: the rope pulls only while it is taut, from t1 to t2
right: closed form, a fall, an oscillation and a throw
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
]]
-- The bound: t1 and t2 are no multiples of a step, so the step is cut there; what order 2 leaves at h = 1/1000 s is
-- h^2 w^3 (t2 - t1)/3 = 4e-4 of 0.2 m.
local scene = hooke.scene { duration = 0.9, fps = 500, accuracy = 2e-4 }
local k, l, g, z0 = 400, 1, 9.81, -0.2 -- N/m, m, m/s^2, m; 1 kg
local w = math.sqrt(k)

-- Down at v1 at t1; then s = g/w^2 + A cos(w t - phase) below the rope's length, until s = 0 again.
local t1 = math.sqrt(2 * (l + z0) / g)
local v1, rest = g * t1, g / k
local A, phase = math.sqrt(rest ^ 2 + (v1 / w) ^ 2), math.atan(v1 / w, -rest)
local t2 = t1 + 2 * phase / w

scene:particles { positions = { { 0, 0, 0 }, { 0, 0, z0 } }, mass = 1 }
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = { { 1, 2 } }, k = k, rest = l, from = t1, to = t2 })

scene:exact(function(t)
  local z
  if t < t1 then
    z = z0 - g * t * t / 2
  elseif t < t2 then
    z = -l - rest - A * math.cos(w * (t - t1) - phase)
  else
    z = -l + v1 * (t - t2) - g * (t - t2) ^ 2 / 2
  end
  return 0, 0, 0, 0, 0, z
end)
return scene
