--[[
what: a weight of 1 kg swings on a stiff string of beads of 1 g
right: tests/study/answers_springs.c, printed with 17 digits
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
]]
-- The bound: bdf2 at h = 1/120 s is off by h^2 w^3 T/3 = 2e-4 of 0.5 m; the waves along the string (up to 450 1/s) that
-- such steps damp have some 5e-4 m, as bdf2 shows.
local scene = hooke.scene { duration = 0.3, accuracy = 2e-3 }
local k, mass, g = 1e5, 1, 9.81

-- 60 degrees from the vertical, at rest, as long as half the weight stretches it.
local l, positions, masses, edges = 0.125 + mass * g / 2 / k, {}, {}, {}
for i = 0, 8 do
  positions[i + 1] = { i * l * math.sqrt(0.75), 0, -i * l / 2 }
  masses[i + 1] = i == 8 and mass or 1e-3
  if i > 0 then edges[i] = { i, i + 1 } end
end
scene:particles { positions = positions, masses = masses }
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -g } })
scene:force("springs", { edges = edges, k = k, rest = 0.125 })

local answer = {
  0, 0, 0,
  0.07850516702765483, 0, -0.097440721304760703,
  0.15703862847310936, 0, -0.19485849445058594,
  0.23560186730621666, 0, -0.29225206768462829,
  0.31422282389008851, 0, -0.38959886547079449,
  0.39295639040228484, 0, -0.48685443865814037,
  0.47180503506198129, 0, -0.58401653194572516,
  0.55073271269200209, 0, -0.68111421401820776,
  0.6297084542737375, 0, -0.77817260890243128,
}
scene:exact(function(t) if t == 0.3 then return table.unpack(answer) end end)
return scene
