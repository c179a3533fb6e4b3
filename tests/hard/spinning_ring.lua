--[[
what: a ring of 12 springs spins in equilibrium, tension against centrifugal force; the whole body turns at every step
right: closed form, m w^2 R = 2 k (l - L) sin(pi/n) for every particle
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, dopri5, tr_bdf2, esdirk4
also: implicit_midpoint dt=1/240; bdf2 dt=1/240
]]
-- The bound: leapfrog errs by some (h w)^2/6 w T = 2e-4 rad at h = 1/480 s, of a radius of 1 m; four times that.
local n, R, w, m, k = 12, 1, 2 * math.pi, 0.01, 1000
local scene = hooke.scene { duration = 1.3, fps = 240, tol = 1e-8, accuracy = 1e-3 }

local edges, half = {}, math.pi / n
for i = 1, n do
  local a = 2 * half * i
  scene:particle { position = { R * math.cos(a), R * math.sin(a), 0 }, mass = m,
    velocity = { -R * w * math.sin(a), R * w * math.cos(a), 0 } }
  edges[i] = { i, i % n + 1 }
end
scene:force("springs", { edges = edges, k = k,
  rest = 2 * R * math.sin(half) - m * w * w * R / (2 * k * math.sin(half)) })

scene:exact(function(t)
  local x = {}
  for i = 1, n do
    local a = 2 * half * i + w * t
    x[i] = { R * math.cos(a), R * math.sin(a), 0 }
  end
  return x
end)
return scene
