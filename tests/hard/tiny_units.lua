--[[
what: a chain of 1 mm and 1 mg that rings 400 times a second: millimetres, milligrams, milliseconds
right: closed form, the slowest normal mode of a chain held at one end
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid
]]
-- The bound: a hundredth of the amplitude; leapfrog at h = 5e-5 s lags by (h w)^2/24 w T = 8e-3 of it after two
-- periods.
local n, a, m, k, A = 8, 1.25e-4, 1.25e-7, 23, 1e-5
local theta, o = math.pi / (2 * n + 1), { 0, 0, 0 }
local w = 2 * math.sqrt(k / m) * math.sin(theta / 2)
local scene = hooke.scene { duration = 5e-3, fps = 2e4, tol = 1e-8, accuracy = 1e-7 }

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
