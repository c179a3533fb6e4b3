--[[
what: a ball lands at the very end of a frame, bounces, and lands at the end of another one, six times
right: closed form in pieces, parabolas between landings
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4, imex
also: symplectic_euler; backward_euler; euler
]]
-- The bound: impacts are found inside the step, and methods of order 2 follow parabolas exactly; implicit ones solve to
-- 1e-6 of a step's change of speed, 1e-7 m/s, in each of some hundred steps.
local g, first, e = 9.81, 0.5, 0.8 -- s: the first landing; then flights of 0.8, 0.64, ... s, multiples of 1/15625 s
local scene = hooke.scene { duration = 3, fps = 125, tol = 1e-8, accuracy = 1e-5 }

scene:particle { position = { 0, 0, g * first ^ 2 / 2 }, mass = 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:corrector("obstacle", { restitution = e })

scene:exact(function(t)
  if t < first then return 0, 0, g * (first ^ 2 - t ^ 2) / 2 end
  local v, s = e * g * first, t - first
  while s > 2 * v / g do
    s = s - 2 * v / g
    v = e * v
  end
  return 0, 0, v * s - g * s * s / 2
end)
return scene
