--[[
what: a mast of three chords buckles under more than Euler's load, as it should, and comes to rest bent
right: tests/study/answers_springs.c, printed with 17 digits
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4,
  backward_euler
]]
-- The bound: at t = 4 s the mast is at rest to 1e-4 m, so that the path does not matter, only where it leads.
local scene = hooke.scene { duration = 4, accuracy = 1e-3, accuracy_at = "end" }

local r, l = 0.05, 0.1
local y, z = { r, -r / 2, -r / 2 }, { 0, r * math.sqrt(3) / 2, -r * math.sqrt(3) / 2 }
local positions, rings, chords, diagonals = {}, {}, {}, {}
for i = 0, 8 do
  for j = 1, 3 do
    positions[3 * i + j] = { l * i, y[j] - 1e-3 * (1 - math.cos(math.pi * l * i / 1.6)), z[j] }
    rings[3 * i + j] = { 3 * i + j, 3 * i + j % 3 + 1 }
    if i > 0 then
      chords[#chords + 1] = { 3 * i - 3 + j, 3 * i + j }
      diagonals[#diagonals + 1] = { 3 * i - 3 + j, 3 * i + j % 3 + 1 }
      diagonals[#diagonals + 1] = { 3 * i - 3 + j % 3 + 1, 3 * i + j }
    end
  end
end
scene:particles { positions = positions, mass = 0.01 }
scene:pin { 1, 2, 3 }
scene:force("drag", { rate = 6 })
scene:force("springs", { edges = rings, k = 1e4, label = "rings" })
scene:force("springs", { edges = chords, k = 4e3, label = "chords" })
scene:force("springs", { edges = diagonals, k = 1e4, label = "diagonals" })
scene:force("gravity", { only = { 25, 26, 27 }, label = "load", g = function(t) -- 300 m/s^2 x 0.01 kg
  local p = math.min(t / 0.3, 1)
  return -300 * p * p * (3 - 2 * p), 0, 0
end })

local answer = {
  0, 0.05, 0,
  0, -0.025, 0.043301270189221932,
  0, -0.025, -0.043301270189221932,
  0.11194962353749377, 0.033704140888333722, -4.4151853412235277e-18,
  0.092990695692441624, -0.033993179014279674, 0.045730391161247778,
  0.092990695692441585, -0.033993179014279688, -0.045730391161247766,
  0.21602169940796049, -0.013725983416208589, 7.287193363351367e-18,
  0.17705635328892364, -0.073505712764761855, 0.045184851710925914,
  0.17705635328892364, -0.073505712764761852, -0.045184851710925917,
  0.30109886926038, -0.087242375547405308, -4.0836416754058236e-18,
  0.2476224443058075, -0.13532523242920108, 0.044938873680134759,
  0.24762244430580749, -0.1353252324292011, -0.044938873680134757,
  0.36513487279487598, -0.17710063039256293, 2.5065243649460148e-19,
  0.30201262347161845, -0.21300039335316177, 0.044598615618199128,
  0.30201262347161843, -0.21300039335316177, -0.044598615618199145,
  0.40998376083103931, -0.27534153880293112, 1.8502628556770701e-18,
  0.34118174377913778, -0.30061260462866003, 0.044256210025250907,
  0.34118174377913777, -0.30061260462866003, -0.044256210025250902,
  0.43994479774121923, -0.37661690536119041, -4.3159543146434717e-18,
  0.36807679970013471, -0.39395606777411248, 0.043922781262588345,
  0.36807679970013474, -0.39395606777411247, -0.043922781262588352,
  0.46006361352520183, -0.4779253809123771, 5.8429901104750468e-18,
  0.38662507071033901, -0.49048470994148645, 0.043609113209319999,
  0.38662507071033899, -0.49048470994148649, -0.043609113209319999,
  0.47529343343640815, -0.57781303598945736, -6.7277443819560975e-18,
  0.40107267301320798, -0.58884850046224701, 0.043294012569934434,
  0.40107267301320802, -0.58884850046224702, -0.043294012569934418,
}
scene:exact(function(t) if t == 4 then return table.unpack(answer) end end)
return scene
