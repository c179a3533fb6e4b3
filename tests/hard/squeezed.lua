--[[
what: a tetrahedron of springs squeezed to a thousandth of its size bursts open
right: closed form, the breathing of a regular tetrahedron, w^2 = 4 k/m
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
]]
-- The bound: bdf2 at h = 1/12000 s is off by h^2 w^3 T/3 = 3e-5 of 0.6 m (w = 63 1/s, T = 0.06 s).
local scene = hooke.scene { duration = 0.06, fps = 6000, accuracy = 1e-4 }
local k, m, L, squeezed = 100, 0.1, 1, 1e-3

local function corners(side)
  local a = side / math.sqrt(8)
  return a, a, a, a, -a, -a, -a, a, -a, -a, -a, a
end

local x = { corners(squeezed * L) }
local positions = {}
for i = 1, 4 do positions[i] = { x[3 * i - 2], x[3 * i - 1], x[3 * i] } end
scene:particles { positions = positions, mass = m }
scene:force("springs", { edges = { { 1, 2 }, { 1, 3 }, { 1, 4 }, { 2, 3 }, { 2, 4 }, { 3, 4 } }, k = k, rest = L })

scene:exact(function(t) return corners(L - (1 - squeezed) * L * math.cos(2 * math.sqrt(k / m) * t)) end)
return scene
