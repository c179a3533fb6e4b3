--[[
what: a swinging mass is stopped by a floor at the end of a step, and swings on from there: a corrector amid a
  method's history
right: closed form in pieces, A cos w t until it meets the floor, then from rest there
must: leapfrog, stoermer, stoermer5, rk4, midpoint, implicit_midpoint, implicit_trapezoid, bdf2, imex, dopri5,
  tr_bdf2, esdirk4
trust: the floor is a plugin for tests, tests/fixtures/floor.c
]]
-- The bound: the floor acts at the end of the step, up to h = 1e-3 s late, and the mass swings on that much later:
-- h times its speed at the end, 1.4 m/s.
local fixtures = param("fixtures", "../../build/tests/fixtures", "folder of the built plugins for tests")
local w, A, height = 10, 0.2, -0.15
local scene = hooke.scene { duration = 0.5, fps = 1000, tol = 1e-8, accuracy = 2e-3 }

scene:particle { position = { 0, 0, A }, mass = 1 }
scene:force("central", { strength = w * w, power = 1 })
scene:corrector(fixtures .. "/floor.so", { height = height })

scene:exact(function(t)
  local stop = math.acos(height / A) / w
  return 0, 0, t < stop and A * math.cos(w * t) or height * math.cos(w * (t - stop))
end)
return scene
