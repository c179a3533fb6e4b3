-- A charge in a magnetic field turns with q B/m on a circle of m v/(q B); with an electric field across, the circle
-- drifts with E x B/B^2.
local validation = require("validation")

local B, ratio, v, E = 2, 3, 1.5, 0.4 -- T, C/kg, m/s, V/m
local w = ratio * B
local turns = 2.25
local T = turns * 2 * math.pi / w

return validation.problem {
  title = "A charge in a magnetic field",
  together = true,
  quantities = {
    { name = "x after 2.25 turns (gyration)", unit = "m", reference = v / w, scale = v / w,
      source = "closed form: circle of m v/(q B)" },
    { name = "y after 2.25 turns (gyration)", unit = "m", reference = -v / w, scale = v / w,
      source = "closed form: circle of m v/(q B)" },
    { name = "x after 2.25 turns (E x B)", unit = "m", reference = E / B * T + (0 - E / B) / w, scale = v / w,
      source = "closed form: drift E/B and a turn of the rest" },
    { name = "y after 2.25 turns (E x B)", unit = "m", reference = -(0 - E / B) / w, scale = v / w,
      source = "closed form: drift E/B and a turn of the rest" },
  },
  time = { T / 90, T / 180, T / 360 },
  order = { time = 4 },
  tolerance = 1e-6,
  why = "order 4: (w h)^4/120 w t = 4e-7 at the finest step",
  forces = { magnetic = { "B", "ratio" } },
  quick = { time = { T / 45, T / 90, T / 180 }, tolerance = 1e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = T, fps = 1 / T, dt = at.h, integrator = "rk4" }
    local p = scene:particle { position = { 0, 0, 0 }, velocity = { v, 0, 0 }, mass = 1 }
    local q = scene:particle { position = { 0, 0, 0 }, velocity = { 0, 0, 0 }, mass = 1 }
    scene:force("magnetic", { B = { 0, 0, B }, ratio = ratio })
    scene:force("gravity", { g = { 0, ratio * E, 0 }, only = { q } }) -- q E/m
    local s = scene:run():state()
    local a, b = s:position(p), s:position(q)
    return { a[1], a[2], b[1], b[2] }
  end,
}
