--[[
what: the double pendulum for so long that an error of 1e-10 m grows to its whole length: nobody can be right by design
right: tests/study/answers_motion.c, with 64 bits of mantissa
must: none
also: rk4 dt=4e-3; blanes_moan dt=4e-3; dopri5 tol=1e-7
]]
-- The bound: a hundredth of the length of 2 m. The answer is known to 1e-4 m; a disturbance of 1e-10 m, which is more
-- than any method makes in a step, ends as far off as the pendulum is long.
local scene = hooke.scene { duration = 30, fps = 60, tol = 1e-5, accuracy = 0.02 }

for i = 1, 3 do scene:particle { position = { i - 1, 0, 0 }, mass = 1 } end
scene:pin { 1 }
scene:force("gravity", { g = { 0, 0, -10 } })
scene:force("springs", { edges = { { 1, 2 }, { 2, 3 } }, k = 1000, rest = 1 })

local answer = {
  0, 0, 0,
  -0.49858595723477846, 0, -0.75589136280595864,
  0.24785651764459075, 0, -1.3383665165368404,
}
scene:exact(function(t) if t == 30 then return table.unpack(answer) end end)
return scene
