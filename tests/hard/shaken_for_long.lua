--[[
what: a pin shakes at 300 Hz by a clock that began 2,000 s ago, and gives no velocity, which its damper needs
right: closed form, a driven oscillator with damping that starts from rest
must: rk4, dopri5, leapfrog, implicit_midpoint
]]
-- The bound: a thousandth of the pin's amplitude.
local p, T0, A = 2 * math.pi * 300, 2000, 0.01 -- 1/s, s, m
local w, g = 100, 20 -- 1/s: of the oscillator x'' = -w^2 (x - u) - g (x' - u'), u = A sin(p (t + T0))
local scene = hooke.scene { duration = 0.1, fps = 20000, tol = 1e-9, accuracy = 1e-5 }

scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:particle { position = { 1, 0, 0 }, mass = 1 }
scene:pin({ 1 }, { path = function(t) return A * math.sin(p * (t + T0)), 0, 0 end })
scene:force("springs", { edges = { { 1, 2 } }, k = w * w, rest = 1, damping = g })

-- Steady part C sin + D cos of p (t + T0), from (w^2 + i g p) / (w^2 - p^2 + i g p); then what starts at rest.
local re, im = w * w - p * p, g * p
local n = re * re + im * im
local C, D = A * (w * w * re + im * im) / n, A * (im * re - w * w * im) / n
local function steady(t)
  local q = p * (t + T0)
  return C * math.sin(q) + D * math.cos(q), p * (C * math.cos(q) - D * math.sin(q))
end
local x0, v0 = steady(0)
local f = math.sqrt(w * w - g * g / 4)
local a, b = -x0, (-v0 - g / 2 * x0) / f
scene:exact(function(t)
  local decay = math.exp(-g * t / 2)
  local own = decay * (a * math.cos(f * t) + b * math.sin(f * t))
  return A * math.sin(p * (t + T0)), 0, 0, 1 + steady(t) + own, 0, 0
end)
return scene
