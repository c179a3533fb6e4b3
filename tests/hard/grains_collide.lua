--[[
what: two stiff grains collide; their contact lasts 2 ms and takes half of the speed, in steps of any length
right: closed form, a damped half wave that ends when its force does (Schwager and Poeschel 2007)
must: leapfrog, stoermer, blanes_moan, rk4, dopri5
also: euler dt=1e-4; dopri5 tol=1e-3
]]
-- The bound: the force begins with a jump, which is seen up to a step h too late: z w h of the speed is missed, with
-- w = 1414 1/s, z = 0.24 and h = 1/20000 s; for 0.15 s at 1 m/s that is 3e-3 m.
local scene = hooke.scene { duration = 0.2, fps = 20000, tol = 1e-8, accuracy = 3e-3 }
local R, k, m, gap, v, e = 0.1, 1e6, 1, 0.05, 1, 0.5
scene:particles { positions = { { 0, 0, 0 }, { 2 * R + gap, 0, 0 } }, velocities = { { v, 0, 0 }, { 0, 0, 0 } }, mass = m }
scene:force("soft_spheres", { radius = R, stiffness = k, restitution = e })

local w = math.sqrt(k / (m / 2))
local low, high = 0, 1 -- z by bisection
for _ = 1, 60 do
  local z = (low + high) / 2
  if math.exp(-2 * z * math.acos(z) / math.sqrt(1 - z * z)) > e then low = z else high = z end
end
local z = low
local turn = w * math.sqrt(1 - z * z)
local lasts = 2 * math.acos(z) / turn
scene:exact(function(t)
  local s = t - gap / v
  local approach = v * t -- of the two, less the distance
  if s > lasts then
    approach = gap + v / turn * math.exp(-z * w * lasts) * math.sin(turn * lasts) - e * v * (s - lasts)
  elseif s > 0 then
    approach = gap + v / turn * math.exp(-z * w * s) * math.sin(turn * s)
  end
  local centre = R + gap / 2 + v * t / 2
  local half = R + (gap - approach) / 2
  return centre - half, 0, 0, centre + half, 0, 0
end)
return scene
