-- A tank empties through a slot beside its wall and is filled through the wall across it: the speed of the jet below the
-- slot, whose lip is round, so that no eddies take anything.
local filling = require("filling")
local validation = require("validation")

local g, floor, depth, slot, lip, step = 9.81, 0.6, 0.6, 0.125, 0.1, 0.002 -- m/s^2, m: the tank's floor, its water, the slot; s
local inflow = slot * math.sqrt(2 * g * (depth + lip)) / depth -- m/s: about what goes through the slot, narrowest below the lip
local from, to, looks = 1.5, 3, 30 -- s: when the flow has become steady, but for a slow change of the level
local low, high, left, right = 0.2, 0.35, 0.5, 0.75 -- m: where the jet is looked at, and the surface

-- The level over [left, right] and the speed there: together the water's head, z + v^2/(2 g), above z = 0, m.
local function head(state, cell)
  local count, squares, near = 0, 0, 0
  local function is_beside(p) return p[3] > floor and p[1] > left and p[1] < right end
  for _, id in ipairs(state:ids()) do
    if is_beside(state:position(id)) then count = count + 1 end
  end
  local level = floor + count * (cell / 2) ^ 2 / (right - left)
  for _, id in ipairs(state:ids()) do
    local p, v = state:position(id), state:velocity(id)
    if is_beside(p) and p[3] > level - 1.5 * cell then squares, near = squares + v[1] ^ 2 + v[3] ^ 2, near + 1 end
  end
  return level + squares / near / (2 * g)
end

return validation.problem {
  title = "Torricelli's law",
  quantities = { { name = "speed of the jet, by sqrt(2 g (H - z))", reference = 1,
    source = "Torricelli 1644, Bernoulli 1738, for a flow that is steady and H its head at the surface" } },
  space = { 24, 32, 48 },
  noise = 0.015,
  tolerance = 0.03,
  why = "the level still moves by 0.1 m/s, so that the surface's flow and the tank's slow waves leave 1 to 2 % of the mean over 1.5 s",
  quick = { space = { 12, 16, 20 }, tolerance = 0.08 },
  solve = function(at)
    local cell = 1 / at.n
    local s = hooke.scene { duration = to, fps = looks / (to - from), dt = step, integrator = "symplectic_euler" }
    local water = filling.box { low = { 0, 0, 0 }, high = { 1, 0, floor + depth }, cell = cell, density = 1000, scatter = 0,
      inside = function(_, _, z) return z > floor end }
    s:particles { positions = water.positions, mass = water.mass }
    s:force("gravity", { g = { 0, 0, -g } })
    s:corrector("obstacle", { shape = "sphere", size = { 2 * lip, 2 * lip, 2 * lip }, position = { slot + lip, 0, floor - lip } })
    s:corrector("obstacle", { shape = "box", size = { 2, 1, lip }, position = { slot + 1, 0, floor - 1.5 * lip } })
    s:corrector("obstacle", { shape = "box", size = { 2, 1, 2 * lip }, position = { slot + lip + 1, 0, floor - lip } })
    s:source("inflow", { low = { 1, 0, floor }, high = { 1, 0, floor + depth }, direction = { -1, 0, 0 }, speed = inflow, cell = cell })
    s:source("drain", { low = { 0, -1, 0 }, high = { 1, 1, 0.1 } })
    s:corrector("liquid", { low = { 0, 0, 0 }, high = { 1, 0, floor + 1.5 * depth }, cell = cell, density = 1000 })
    local sum, count = 0, 0
    for k = 0, looks do
      local state = s:run { to = from + k * (to - from) / looks }:state()
      local H = head(state, cell)
      for _, id in ipairs(state:ids()) do
        local p, v = state:position(id), state:velocity(id)
        if p[1] < slot and p[3] > low and p[3] < high then
          sum, count = sum + math.sqrt((v[1] ^ 2 + v[3] ^ 2) / (2 * g * (H - p[3]))), count + 1
        end
      end
    end
    return sum / count
  end,
}
