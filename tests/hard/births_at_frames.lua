--[[
what: births and deaths fall on the ends of frames, where rounding decides whether a particle is there, and on both sides
right: closed form, throws in air; a particle is there from its birth on, and no longer at its death
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid, bdf2,
  tr_bdf2, esdirk4
also: symplectic_euler; euler; implicit_midpoint dt=1/50
]]
-- The bound: leapfrog at h = 1/200 s is off by (drag h)^2/12 of 0.5 m, 4e-6 m; what is restarted at every birth, as bdf2,
-- by some drag h of it.
local drag, g, speed, rate, life = 2, 9.81, 4, 50, 0.25
local scene = hooke.scene { duration = 0.5, fps = 200, tol = 1e-8, accuracy = 1e-3 }

scene:force("gravity", { g = { 0, 0, -g } })
scene:force("drag", { rate = drag })
scene:source("emitter", { rate = rate, speed = speed, direction = { 1, 0, 1 }, lifetime = life })

scene:exact(function(t)
  local x = {}
  for k = 0, math.floor(t * rate + 1e-9) do
    local s = t - k / rate
    if k / rate + life > t then
      local c = speed / math.sqrt(2)
      x[#x + 1] = { c * (1 - math.exp(-drag * s)) / drag, 0,
        (c + g / drag) * (1 - math.exp(-drag * s)) / drag - g / drag * s }
    end
  end
  return x
end)
return scene
