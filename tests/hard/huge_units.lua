--[[
what: a chain of 1000 km and 80,000 t that swings once in ten hours: kilometres, tonnes, hours
right: closed form, the slowest normal mode of a chain held at one end
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: a hundredth of the amplitude; leapfrog at h = 250 s lags by (h w)^2/24 w T = 1e-3 of it after two periods.
local n, a, m, k, A = 8, 1.25e5, 1e7, 8, 1e4
local theta, o = math.pi / (2 * n + 1), { 0, 0, 0 }
local w = 2 * math.sqrt(k / m) * math.sin(theta / 2)
local scene = hooke.scene { duration = 72000, fps = 0.004, tol = 1e-8, accuracy = 100 }

local function at(i, t) return { o[1] + i * a + A * math.sin(i * theta) * math.cos(w * t), o[2], o[3] } end
local edges = {}
for i = 0, n do
  scene:particle { position = at(i, 0), mass = m }
  if i > 0 then edges[i] = { i, i + 1 } end
end
scene:pin { 1 }
scene:force("springs", { edges = edges, k = k, rest = a })

scene:exact(function(t)
  local x = {}
  for i = 0, n do x[i + 1] = at(i, t) end
  return x
end)
return scene
