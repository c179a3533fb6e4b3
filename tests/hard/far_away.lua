--[[
what: a chain of a metre a thousand kilometres from the origin, where a coordinate has 1e-10 m
right: closed form, the slowest normal mode of a chain held at one end
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: a hundredth of the amplitude; leapfrog at h = 1/480 s lags by (h w)^2/24 w T = 4e-4 of it, and rounding
-- grows to some 1e-9 m.
local n, a, m, k, A = 8, 0.125, 0.0125, 80, 0.05
local theta, o = math.pi / (2 * n + 1), { 1e6, -1e6, 1e6 }
local w = 2 * math.sqrt(k / m) * math.sin(theta / 2)
local scene = hooke.scene { duration = 0.7, fps = 480, tol = 1e-8, accuracy = 5e-4 }

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
