--[[
what: a spring is pressed until its ends meet and pass through each other, where its force jumps from push to push back
right: closed form, an oscillation about the rest length on either side
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: the acceleration jumps by 2 k L/m = 200 m/s^2 inside a step of h = 1/4000 s. A step takes it for up to
-- half of its length too early or too late, which leaves 0.025 m/s and so 0.025/w = 1.8e-3 m, w = 14 1/s; twice that.
local scene = hooke.scene { duration = 0.35, fps = 4000, accuracy = 4e-3 }
local k, L, V = 100, 1, 20 -- N/m, m, m/s; masses of 1 kg
local w = math.sqrt(2 * k)

scene:particles { positions = { { -L / 2, 0, 0 }, { L / 2, 0, 0 } }, velocities = { { V / 2, 0, 0 }, { -V / 2, 0, 0 } },
  mass = 1 }
scene:force("springs", { edges = { { 1, 2 } }, k = k, rest = L })

scene:exact(function(t)
  local meet = math.asin(w * L / V) / w
  local d = L - V / w * math.sin(w * t)
  if t > meet then -- it comes out on the other side with what speed is left
    local s, v = t - meet, math.sqrt(V * V - (w * L) ^ 2)
    d = -(L - L * math.cos(w * s) + v / w * math.sin(w * s))
  end
  return -d / 2, 0, 0, d / 2, 0, 0
end)
return scene
