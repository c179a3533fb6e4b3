--[[
what: gusts of up to 50 Hz shake a mass that is drawn at 10 frames a second
right: quadrature of the gust, which is a known function: twice its integral, by Simpson's rule with 40 parts a period
must: leapfrog, rk4, dopri5, implicit_midpoint, bdf2
also: leapfrog dt=1/10; rk4 dt=1/10; leapfrog dt=1/30; bdf2 dt=1/20; leapfrog dt=0.02
]]
-- The bound: eight steps to the shortest period leave some percent of the change of its waves: of a way of some 0.5 m, 0.01 m.
local scene = hooke.scene { duration = 0.5, fps = 10, tol = 1e-7, accuracy = 0.01 }
local gust = hooke.gust { mean = { 0, 0, 0 }, amplitude = { 20, 20, 20 }, shortest = 0.02, longest = 0.4, seed = 11 }

scene:particle { position = { 0, 0, 0 }, mass = 2 }
scene:force("gravity", { g = gust })

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
