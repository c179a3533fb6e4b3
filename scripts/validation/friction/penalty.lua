-- A ball meets a soft floor: half a swing of m and k, down to v sqrt(m/k), and out again as fast; no gravity.
local validation = require("validation")

local k, m, v, start = 1e4, 0.1, 2, 0.01
local w = math.sqrt(k / m)
local arrive = start / v

return validation.problem {
  title = "Contact with a soft floor",
  quantities = {
    { name = "largest depth", unit = "m", reference = v / w, source = "closed form, v sqrt(m/k)" },
    { name = "height 10 ms after it left", unit = "m", reference = v * 0.01, source = "closed form, contact of pi sqrt(m/k)" },
  },
  time = { 1 / (25 * w), 1 / (50 * w), 1 / (100 * w), 1 / (200 * w) },
  tolerance = 1e-4,
  noise = 2e-5,
  why = "steps end on either side of the contact's begin and end: of order 2, but not regularly",
  forces = { penalty = { "shape", "k" } },
  quick = { time = { 1 / (10 * w), 1 / (20 * w), 1 / (40 * w) }, tolerance = 1e-2 },
  solve = function(at)
    local T = arrive + math.pi / w + 0.01
    local scene = hooke.scene { duration = T, fps = 1 / T, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { 0, 0, start }, velocity = { 0, 0, -v }, mass = m }
    scene:force("penalty", { shape = "plane", k = k })
    local x = scene:run():state():position(p)[3]
    local deep = hooke.scene { duration = arrive + math.pi / 2 / w, fps = 1 / (arrive + math.pi / 2 / w), dt = at.h,
      integrator = "leapfrog" }
    local q = deep:particle { position = { 0, 0, start }, velocity = { 0, 0, -v }, mass = m }
    deep:force("penalty", { shape = "plane", k = k })
    return { -deep:run():state():position(q)[3], x }
  end,
}
