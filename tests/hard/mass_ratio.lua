--[[
what: beads of 1e-6 kg carry a weight of 1 kg between two walls: mass ratio 1e6
right: tests/study/answers_springs.c, printed with 17 digits
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
]]
-- The bound: bdf2 at h = 1/120 s is off by h^2 w^3 T/3 = 5e-3 of 0.3 m (w = 8 1/s, T = 0.4 s). The beads are off the
-- straight lines by 1e-6 of that, so that their ringing (up to 2e4 1/s) does not count.
local scene = hooke.scene { duration = 0.4, accuracy = 2e-3 }

local heavy, positions, masses, edges = { 1.55, 0.1, 0 }, {}, {}, {}
for i = 0, 6 do
  local share, wall = math.min(i, 6 - i) / 3, i < 3 and 0 or 3
  positions[i + 1] = { wall + (heavy[1] - wall) * share, heavy[2] * share, 0 }
  masses[i + 1] = i == 3 and 1 or 1e-6
  if i > 0 then edges[i] = { i, i + 1 } end
end
scene:particles { positions = positions, masses = masses }
scene:pin { 1, 7 }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("springs", { edges = edges, k = 100, rest = 0.4 })

local answer = {
  0, 0, 0,
  0.4829687977264312, 0.003070598754865838, -0.21465304596169923,
  0.9659376828048912, 0.006141221346766472, -0.42930579161512308,
  1.448906613489766, 0.0092118470215463773, -0.64395833339655269,
  1.965937748063049, 0.0061412018046988913, -0.42930568363308443,
  2.4829688717781332, 0.0030705884756717277, -0.21465288877233518,
  3, 0, 0,
}
scene:exact(function(t) if t == 0.4 then return table.unpack(answer) end end)
return scene
