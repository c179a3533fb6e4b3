-- A disc that rolls upright is stable where v^2 > g r/3: with its moments A and C, of a round edge of the radius e on a circle of
-- the radius c, r = c + e, its lean x obeys (A + m r^2) x'' + ((C + m r^2) C W^2/A - m g c) x = 0, as its heading turns by -C W x/A,
-- W its spin. The circle is a ring of n capsules, whose corners take some of the spin.
local validation = require("validation")

local g, c, e, m, lean, t_end = 9.81, 0.19, 0.01, 1, 1e-3, 0.4
local r = c + e
local A, C, I = m * (r ^ 2 / 4 + e ^ 2 / 3), m * r ^ 2 / 2, m * r ^ 2
local limit = m * g * c * A / (C * (C + I)) -- of W^2

-- The lean at t_end in terms of the rate at which it starts: sin(q t)/q, or sinh.
local function reference(part)
  local q2 = (part - 1) * m * g * c / (A + I)
  local q = math.sqrt(math.abs(q2))
  return (q2 > 0 and math.sin(q * t_end) or (math.exp(q * t_end) - math.exp(-q * t_end)) / 2) / q
end

-- With v^2 at a part of the limit. (A flat body, C = 2 A, would be rubbed on its circle, not on the round edge.)
local function leans(part, n, h)
  local scene = hooke.scene { duration = t_end, fps = 5, dt = h, integrator = "leapfrog" }
  local W = math.sqrt(part * limit)
  local disc = scene:rigid { mass = m, inertia = { A, C, A }, position = { 0, 0, r }, velocity = { W * r, -lean * r, 0 },
    spin = { lean, W, 0 } }
  local ring = {}
  for k = 0, n do ring[k + 1] = { c * math.sin(2 * math.pi * k / n), 0, c * math.cos(2 * math.pi * k / n) } end
  disc:surface(ring, { radius = e, joined = true })
  scene:force("gravity", { g = { 0, 0, -g } })
  scene:corrector("obstacle", { friction = 5 })
  local s = scene:run():state()
  local _, R = disc:attitude(s)
  return math.asin(R[3][2]) / lean
end

return validation.problem {
  title = "A disc that rolls upright, on both sides of its stability",
  quantities = {
    { name = "lean/its rate, v^2 at twice the limit", unit = "s", reference = reference(2),
      source = "closed form, linear (Neimark and Fufaev 1972, Dynamics of nonholonomic systems); thin: v^2 = g r/3" },
    { name = "lean/its rate, v^2 at half of the limit", unit = "s", reference = reference(0.5), source = "the same" },
  },
  space = { 100, 200, 400 },
  order = { space = 1 },
  tolerance = 3e-3,
  why = "the corners' loss of spin, of order 1, leaves errors of order 2, 1e-3, and the step as much",
  quick = { space = { 25, 50, 100 }, tolerance = 5e-2 },
  solve = function(at)
    local h = at.quick and 1e-3 or 2.5e-4
    return { leans(2, at.n, h), leans(0.5, at.n, h) }
  end,
}
