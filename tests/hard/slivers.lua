--[[
what: cloth whose triangles are slivers, 0.1 mm by 10 cm: the short sides turn over at the slightest motion
right: tests/study/answers_springs.c, printed with 17 digits
must: stoermer, stoermer5, blanes_moan, rk4, dopri5, tr_bdf2, esdirk4
]]
-- The bound: a short side is 1e-4 m long, and the two ends of it are to be told apart.
local scene = hooke.scene { duration = 0.2, fps = 960, tol = 1e-7, accuracy = 5e-5 }

local positions, edges = {}, {}
local function join(a, b) edges[#edges + 1] = { a, b } end
for j = 0, 3 do
  for i = 0, 3 do
    local p = #positions + 1
    positions[p] = { 0.1 * (i // 2) + 1e-4 * (i % 2), 0.1 * j, 0 }
    if i > 0 then join(p - 1, p) end
    if j > 0 then join(p - 4, p) end
    if i > 0 and j > 0 then join(p - 5, p) end
  end
end
scene:particles { positions = positions, mass = 0.01 }
scene:pin { 13, 16 }
scene:force("gravity", { g = { 0, 0, -9.81 } })
scene:force("springs", { edges = edges, k = 200 })

local answer = {
  0.0030577481295793472, 0.092739043301157914, -0.19453263207816784,
  0.0031228876450391477, 0.092455042617863851, -0.19459270148158602,
  0.10293866806813046, 0.090925858933210305, -0.19435242134545548,
  0.10281951274544413, 0.090595370937998025, -0.19443951015415174,
  0.0040413267326784524, 0.19058016559608811, -0.17017659852997049,
  0.0040188090383834346, 0.19015678701016248, -0.17059964422107959,
  0.10378643630043695, 0.18826223025758587, -0.16808079023823977,
  0.10379069496553603, 0.18786757958937589, -0.16848721262364156,
  0.0022350812986955401, 0.2563594061774917, -0.092709898556473688,
  0.0022207257420933675, 0.25590255559758377, -0.093567281545412541,
  0.10193259045495673, 0.25344764853736494, -0.090443195917456324,
  0.1019691050225379, 0.25315391794753926, -0.090881131598235067,
  0, 0.3, 0,
  0.0001339368045055995, 0.29962110790857026, -0.0021839004868400392,
  0.10006285642877928, 0.29988150822730628, -0.0012729081085612726,
  0.1001, 0.3, 0,
}
scene:exact(function(t) if t == 0.2 then return table.unpack(answer) end end)
return scene
