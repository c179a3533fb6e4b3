--[[
what: a weight of 1 kg swings on four bars with joints of 1 mg, a mass ratio of a million
right: closed form, a rigid pendulum by Jacobi's elliptic functions
must: rk4, dopri5, esdirk4, bdf2
]]
-- The bound: the joints' mass changes the frequency by 4e-6 at most; they may swing sidewise by the kinetic energy that
-- errors of the step give them. Three parts in a thousand of the 0.1 m that the weight moves.
local g, highest, n = 9.81, math.rad(60), 4
local scene = hooke.scene { duration = 0.15, fps = 100, accuracy = 3e-4 }
local place, mass, edges = {}, {}, {}
for k = 0, n do
  place[k + 1] = { k / n * math.sin(highest), 0, -k / n * math.cos(highest) }
  mass[k + 1] = k == n and 1 or 1e-6
  if k > 0 then edges[k] = { k, k + 1 } end
end
scene:particles { positions = place, masses = mass }
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:constraint("bars", { edges = edges })

local function elliptic(u, k) -- sn(u, k), and K(k), by arithmetic and geometric means (Abramowitz and Stegun 16.4)
  local a, b, c, m = { 1 }, math.sqrt(1 - k * k), { k }, 1
  while c[m] > 1e-16 do
    a[m + 1], c[m + 1], b = (a[m] + b) / 2, (a[m] - b) / 2, math.sqrt(a[m] * b)
    m = m + 1
  end
  local angle = 2 ^ (m - 1) * a[m] * u
  for i = m, 2, -1 do angle = (angle + math.asin(c[i] / a[i] * math.sin(angle))) / 2 end
  return math.sin(angle), math.pi / (2 * a[m])
end
scene:exact(function(t) -- sin(theta/2) = k sn(w t + K)
  local k = math.sin(highest / 2)
  local _, quarter = elliptic(0, k)
  local theta = 2 * math.asin(k * elliptic(math.sqrt(g) * t + quarter, k))
  local at = {}
  for j = 0, n do table.move({ j / n * math.sin(theta), 0, -j / n * math.cos(theta) }, 1, 3, #at + 1, at) end
  return table.unpack(at)
end)
return scene
