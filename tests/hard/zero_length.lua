--[[
what: springs without a rest length: two masses pass through each other, a third starts on its own anchor
right: closed form, each is an oscillator about a point at rest
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
]]
-- The bound: bdf2 at h = 1/960 s is off by h^2 w^3 T/3 = 7e-4 of 0.7 m (w = 10 1/s, T = 2 s).
local scene = hooke.scene { duration = 2, fps = 480, accuracy = 1e-3 }
local w = 10

scene:particles { positions = { { -1, 0, 0 }, { 0.5, 0, 0 }, { 0, 3, 0 }, { 0, 3, 0 } }, masses = { 1, 2, 1, 1 },
  velocities = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 3, 0, 4 } } }
scene:pin { 3 }
scene:force("springs", { edges = { { 1, 2 } }, k = w * w * 2 / 3, rest = 0, label = "pair" })
scene:force("springs", { edges = { { 3, 4 } }, k = w * w, rest = 0, label = "anchored" })

scene:exact(function(t)
  local c, s = math.cos(w * t), math.sin(w * t) / w
  return -c, 0, 0, 0.5 * c, 0, 0, 0, 3, 0, 3 * s, 3, 4 * s
end)
return scene
