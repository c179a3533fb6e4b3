--[[
what: three equal masses on Lagrange's equilateral triangle, whose turning is unstable: rounding errors grow 1000 times a turn
right: closed form: a uniform turn with w^2 = G 3 m/d^3
must: dopri5, blanes_moan, rk4
]]
-- The bound: a thousandth of the radius, for a turn and a half: w = 1, so growth is exp(0.707 * 9.4) = 800.
local scene = hooke.scene { duration = 3 * math.pi, fps = 100, tol = 1e-9, accuracy = 1e-3 }
local d = 3 ^ (1 / 3)
local R = d / math.sqrt(3)
local function place(k, t) return R * math.cos(t + 2 * math.pi * k / 3), R * math.sin(t + 2 * math.pi * k / 3) end
for k = 1, 3 do
  local x, y = place(k, 0)
  scene:particle { position = { x, y, 0 }, velocity = { -y, x, 0 }, mass = 1 }
end
scene:force("nbody", { G = 1 })
scene:exact(function(t)
  local at = {}
  for k = 1, 3 do
    at[3 * k - 2], at[3 * k - 1] = place(k, t)
    at[3 * k] = 0
  end
  return table.unpack(at)
end)
return scene
