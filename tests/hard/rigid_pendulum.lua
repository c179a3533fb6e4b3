--[[
what: a rigid pendulum swings nearly over the top, 170 degrees to each side; its rod is a constraint
right: closed form, Jacobi's elliptic functions by descending Landen transformation
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5
trust: the rod is a plugin for tests, tests/fixtures/bar.c
]]
-- The bound: leapfrog's (h w)^2/24 w T = 1.6e-5 rad at h = 1/500 s grows tenfold near the top, on either side; ten
-- times that.
local fixtures = param("fixtures", "../../build/tests/fixtures", "folder of the built plugins for tests")
local g, l, highest = 10, 1, math.rad(170)
local scene = hooke.scene { duration = 3, fps = 500, tol = 1e-8, accuracy = 2e-3 }

scene:particle { position = { 0, 0, 0 }, mass = 1 }
scene:particle { position = { l * math.sin(highest), 0, -l * math.cos(highest) }, mass = 1 }
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:constraint(fixtures .. "/bar.so", { edges = { { 1, 2 } }, length = l })

local function elliptic(u, k) -- sn(u, k), and K(k), by arithmetic and geometric means (Abramowitz and Stegun 16.4)
  local a, b, c, n = { 1 }, math.sqrt(1 - k * k), { k }, 1
  while c[n] > 1e-16 do
    a[n + 1], c[n + 1], b = (a[n] + b) / 2, (a[n] - b) / 2, math.sqrt(a[n] * b)
    n = n + 1
  end
  local angle = 2 ^ (n - 1) * a[n] * u
  for i = n, 2, -1 do angle = (angle + math.asin(c[i] / a[i] * math.sin(angle))) / 2 end
  return math.sin(angle), math.pi / (2 * a[n])
end
scene:exact(function(t) -- sin(theta/2) = k sn(w t + K)
  local k = math.sin(highest / 2)
  local _, quarter = elliptic(0, k)
  local theta = 2 * math.asin(k * elliptic(math.sqrt(g / l) * t + quarter, k))
  return 0, 0, 0, l * math.sin(theta), 0, -l * math.cos(theta)
end)
return scene
