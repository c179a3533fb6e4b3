--[[
what: particles are born at rest while others swing: a source amid a method's history, at 0.1, 0.2, 0.3 and 0.4 s
right: closed form, an oscillation of each from its own beginning
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4
trust: the source is a plugin for tests, tests/fixtures/sower.c
]]
-- The bound: bdf2 at h = 1/2000 s lags by (h w)^2/3 w T = 1.1e-3 of 0.5 m; four times that.
local fixtures = param("fixtures", "../../build/tests/fixtures", "folder of the built plugins for tests")
local w, A, every = 30, 0.5, 0.1
local scene = hooke.scene { duration = 0.475, fps = 1000, tol = 1e-8, accuracy = 2e-3 }

scene:particle { position = { A, 0, 0 }, mass = 1 }
scene:force("central", { strength = w * w, power = 1 })
scene:source(fixtures .. "/sower.so", { every = every, position = { A, 0, 0 }, mass = 0.1 })

scene:exact(function(t)
  local x = {}
  for k = 0, math.floor(t / every) do x[k + 1] = { A * math.cos(w * (t - k * every)), 0, 0 } end
  return x
end)
return scene
