--[[
what: two weights on two stiff springs swing and tumble, before chaos sets in
right: tests/study/answers_motion.c, printed with 17 digits
must: leapfrog, stoermer, stoermer5, blanes_moan, rk4, midpoint, dopri5, implicit_midpoint, implicit_trapezoid,
  tr_bdf2, esdirk4
]]
-- The bound: a hundredth of the length of 2 m; a start that is off by 1e-10 m ends some 1e-8 m off.
local scene = hooke.scene { duration = 2, fps = 500, tol = 1e-8, accuracy = 0.02 }

for i = 1, 3 do scene:particle { position = { i - 1, 0, 0 }, mass = 1 } end
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -10 } })
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 1000, rest = 1 })

local answer = {
  0, 0, 0,
  -0.59766546413696414, 0, -0.84458913438476924,
  -1.5899383924583619, 0, -1.0673931397029306,
}
scene:exact(function(t) if t == 2 then return table.unpack(answer) end end)
return scene
