--[[
what: gusts of 50 Hz behind a function that says nothing of how fast it changes, and steps of a tenth of a second
right: quadrature of the gust, which is a known function: twice its integral, by Simpson's rule with 40 parts a period
must: dopri5
also: leapfrog dt=1/10; rk4 dt=1/10; rk4 dt=1/30; leapfrog dt=0.02; rk4 dt=0.02; bdf2 dt=0.01
]]
-- The bound: as in gust_announced.
local scene = hooke.scene { duration = 0.5, fps = 10, tol = 1e-7, accuracy = 0.01 }
local gust = hooke.gust { mean = { 0, 0, 0 }, amplitude = { 20, 20, 20 }, shortest = 0.02, longest = 0.4, seed = 11 }

scene:particle { position = { 0, 0, 0 }, mass = 2 }
scene:force("gravity", { g = function(t) return gust(t) end })

scene:exact(function(t) -- x(t) is the integral of (t - s) g(s)
  local n, sum = 2 * math.ceil(1000 * t) + 2, { 0, 0, 0 }
  for k = 0, n do
    local s, weight = t * k / n, (k == 0 or k == n) and 1 or k % 2 == 1 and 4 or 2
    local g = { gust(s) }
    for c = 1, 3 do sum[c] = sum[c] + weight * (t - s) * g[c] end
  end
  local h = t / n / 3
  return h * sum[1], h * sum[2], h * sum[3]
end)
return scene
