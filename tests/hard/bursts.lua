--[[
what: bursts in the middle of steps, under a pull that swings with the time, in steps that are long beside its period
right: closed form, the double integral of a cosine from each birth on
must: blanes_moan, rk4, dopri5, esdirk4
also: leapfrog dt=1/100; rk4 dt=1/50; euler; implicit_midpoint dt=1/50; symplectic_euler
]]
-- The bound: leapfrog at h = 1/200 s is off by some (w h)^2/12 of g/w^2 w T, 1e-4 m.
local w, g, speed, burst = 20, 9.81, 3, 5
local times = { 0.0371, 0.2, 0.201, 0.3333 }
local scene = hooke.scene { duration = 0.5, fps = 200, tol = 1e-8, accuracy = 1e-3 }

scene:force("gravity", { g = function(t) return 0, 0, -g * math.cos(w * t) end })
scene:source("emitter", { rate = 0, burst = burst, burst_at = times, speed = speed })

scene:exact(function(t)
  local x = {}
  for _, at in ipairs(times) do
    local s = t - at
    local z = speed * s + g / w ^ 2 * (math.cos(w * t) - math.cos(w * at)) + g / w * s * math.sin(w * at)
    for _ = 1, at <= t and burst or 0 do x[#x + 1] = { 0, 0, z } end
  end
  return x
end)
return scene
