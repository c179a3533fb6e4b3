-- A string lies over half of a cylinder, with a weight on one side: how heavy the other one has to be until it slides,
-- exp(mu pi) times as heavy. Beads on stiff springs, in n parts of the half. Drag makes sliding slow and steady, with a
-- speed in proportion to what is too heavy: two speeds lead to the limit.
local validation = require("validation")

local mu, R, k, mass, drag = 0.3, 1, 2e4, 0.01, 20
local light = 1 -- N

-- The mean speed of sliding in the last second, m/s; the weight is all there after one.
local function speed(n, heavy)
  local scene = hooke.scene { duration = 2.5, fps = 10, dt = 2e-4, integrator = "leapfrog" }
  local ids, edges = {}, {}
  local chord = 2 * R * math.sin(math.pi / n / 2)
  local function bead(x, z)
    ids[#ids + 1] = scene:particle { position = { x, 0, z }, mass = mass }
    if #ids > 1 then edges[#edges + 1] = { ids[#ids - 1], ids[#ids] } end
  end
  bead(-R, -chord)
  for i = 0, n do bead(-R * math.cos(math.pi * i / n), R * math.sin(math.pi * i / n)) end
  bead(R, -chord)
  scene:force("springs", { edges = edges, k = k })
  scene:force("gravity", { g = { 0, 0, -light / mass }, only = { ids[1] }, label = "light" })
  scene:force("gravity", { g = function(t) return 0, 0, -light / mass * (1 + (heavy / light - 1) * math.min(t, 1)) end,
    only = { ids[#ids] }, label = "heavy" })
  scene:force("drag", { rate = drag })
  scene:corrector("obstacle", { shape = "cylinder", size = { 2 * R, 2 * R, 10 }, rotation = { math.pi / 2, 0, 0 },
    friction = mu })
  local before = scene:run { to = 1.5 }:state():position(ids[1])[3]
  return scene:run():state():position(ids[1])[3] - before
end

return validation.problem {
  title = "A string around half a cylinder",
  quantities = {
    { name = "ln(heavy/light)/pi", reference = mu, source = "Euler 1769, Eytelwein 1808: exp(mu phi)" },
  },
  space = { 4, 8, 16 },
  order = { space = 2, within = 0.5 },
  tolerance = 5e-3,
  why = "the beads move on by a hundredth of the radius, a tenth of their distance, while their speed is measured",
  quick = { space = { 4, 8, 16 }, tolerance = 1e-2 },
  solve = function(at)
    local guess = light * math.exp(mu * math.pi)
    local a, b = 1.06 * guess, 1.10 * guess
    local va, vb = speed(at.n, a), speed(at.n, b)
    return math.log((a * vb - b * va) / (vb - va) / light) / math.pi
  end,
}
