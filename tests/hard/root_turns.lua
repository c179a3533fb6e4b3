--[[
what: the root of a hair turns 80 times a second, and the hair stands out from it; both ends of its first edge are pinned
right: closed form: the hair turns with its root like a rigid body, each spring stretched by what holds it there
must: leapfrog, stoermer, rk4, blanes_moan, dopri5, arkode, cvode, esdirk4, implicit_trapezoid
]]
-- The bound: a hair that lags behind by a thousandth of a turn at its end, 0.1 m away.
local n, l, k, m, W = 4, 0.02, 1000, 1e-5, 500
local scene = hooke.scene { duration = 0.1, fps = 2000, accuracy = 5e-4 }

-- Distances from the axis: the spring to node i bears all beyond it, k (r_i - r_(i-1) - l) = sum m W^2 r.
local function distances()
  local r, stretch = {}, {}
  for i = 1, n + 2 do r[i] = l * i end
  for _ = 1, 200 do
    for i = n + 2, 3, -1 do stretch[i] = (stretch[i + 1] or 0) + m * W * W * r[i] / k end
    for i = 3, n + 2 do r[i] = r[i - 1] + l + stretch[i] end
  end
  return r
end

local r, edges, free, list = distances(), {}, {}, {}
for i = 1, n + 2 do
  list[i] = scene:particle { position = { r[i], 0, 0 }, velocity = { 0, r[i] * W, 0 }, mass = m }
  if i > 1 then edges[i - 1] = { list[i - 1], list[i] } end
  if i > 2 then free[i - 2] = edges[i - 1] end
end
for i = 1, 2 do
  scene:pin({ list[i] }, { path = function(t)
    local c, s = math.cos(W * t), math.sin(W * t)
    return r[i] * (c - 1), r[i] * s, 0, -r[i] * W * s, r[i] * W * c, 0
  end })
end
scene:force("springs", { edges = free, k = k, rest = l })
scene:force("rods", { edges = edges, EI = 1e-5, GJ = 1e-5, EI2 = 3e-5, axis = { 0, 0, 1 } })

scene:exact(function(t)
  local answer = {}
  for i = 1, n + 2 do
    answer[3 * i - 2], answer[3 * i - 1], answer[3 * i] = r[i] * math.cos(W * t), r[i] * math.sin(W * t), 0
  end
  return table.unpack(answer)
end)
return scene
