--[[
what: a strip, straight to a given millimetre, is pressed by half more than it bears and buckles, caught on its way
right: tests/study/answers_springs.c, printed with 17 digits
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
]]
-- A clamped column, EI = k l b^2/2 = 1.25 N m^2 (two chords): Euler's load is pi^2 EI/(4 L^2) = 2.14 N, it bears 3.2 N.
-- The bound: the deflection has grown like exp(4.3 t) to 0.05 m. Backward Euler at h = 1/480 s grows by h s^2 T/2 = 2 %
-- too slowly, 1e-3 m; methods of order 2 are off by 1e-5 m.
local scene = hooke.scene { duration = 1, fps = 240, accuracy = 2e-4 }

local positions, chords, diagonals = {}, {}, {}
for i = 0, 12 do
  for j = 0, 1 do
    local x, p = 0.1 * i, #positions + 1
    positions[p] = { x, 0.05 * j + 1e-3 * (1 - math.cos(math.pi * x / 2.4)), 0 }
    if j > 0 then chords[#chords + 1] = { p - 1, p } end
    if i > 0 then chords[#chords + 1] = { p - 2, p } end
    if i > 0 then diagonals[#diagonals + 1] = { j > 0 and p - 3 or p - 1, p } end
  end
end
local strip = scene:particles { positions = positions, mass = 0.01 }
local free = {}
for p = 3, 26 do free[p - 2] = strip:at(p) end
scene:pin { strip:at(1), strip:at(2) }
scene:pin(free, { normal = { 0, 0, 1 } })
scene:force("springs", { edges = chords, k = 1e4, label = "chords" })
scene:force("springs", { edges = diagonals, k = 5e3, label = "diagonals" })
scene:force("gravity", { only = { 25, 26 }, label = "load", g = function(t) -- 160 m/s^2 x 0.01 kg
  local p = math.min(t / 0.3, 1)
  return -160 * p * p * (3 - 2 * p), 0, 0
end })

local answer = {
  0, 0, 0,
  0, 0.05, 0,
  0.10005906435177486, 0.00030238504074323252, 0,
  0.099705169250971512, 0.050341400300314653, 0,
  0.20012352622480427, 0.0013893029042853657, 0,
  0.19938865935862572, 0.051422655344944495, 0,
  0.30018460249441795, 0.0032844499327524681, 0,
  0.29905172191087294, 0.053310338484618762, 0,
  0.40022953737695433, 0.0060115290466044721, 0,
  0.39869262091616576, 0.056026625413048438, 0,
  0.50024572530434787, 0.0095703602496598493, 0,
  0.498310158152703, 0.059571682711224391, 0,
  0.60022148504116034, 0.013937164056948691, 0,
  0.59790424651020263, 0.0639223886832011, 0,
  0.70014689188550212, 0.019064438007882485, 0,
  0.69747659057511364, 0.06903223762160206, 0,
  0.80001449470050742, 0.024881071533759338, 0,
  0.79703130025287045, 0.074831396644861309, 0,
  0.89981988889914415, 0.03129262004654635, 0,
  0.89657535001256221, 0.081226889003795157, 0,
  0.99956210950442131, 0.038181843299939716, 0,
  0.99611879335332933, 0.088102990183149022, 0,
  1.0992437515578356, 0.045409322697066578, 0,
  1.0956745641149154, 0.095322460372458433, 0,
  1.1988714673728507, 0.052826602124780551, 0,
  1.1952603555415426, 0.10271673481963466, 0,
}
scene:exact(function(t) if t == 1 then return table.unpack(answer) end end)
return scene
