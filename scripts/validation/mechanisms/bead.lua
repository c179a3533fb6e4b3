-- A bead without friction on a rod that is turned at w: at rest on it at first it goes out as r = r_0 cosh(w t), and presses on it
-- with 2 m w r' (Landau and Lifshitz, Mechanics, section 39).
local validation = require("validation")

local w, r0, m, t = 2, 0.1, 3, 1 -- rad/s, m, kg, s

return validation.problem {
  title = "A bead on a turning rod",
  quantities = {
    { name = "distance", unit = "m", reference = r0 * (math.exp(w * t) + math.exp(-w * t)) / 2,
      source = "closed form (Landau and Lifshitz, Mechanics, 39)" },
    { name = "force", unit = "N", reference = m * w * r0 * w * (math.exp(w * t) - math.exp(-w * t)),
      source = "closed form, 2 m w r'" },
  },
  time = { 0.02, 0.01, 0.005 },
  order = { time = 2 },
  tolerance = 1e-7,
  why = "errors of order 2 leave those of order 4",
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-5 },
  solve = function(at)
    local scene = hooke.scene { duration = t, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local ends = {}
    for k, p in ipairs { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0.5, 1 } } do ends[k] = scene:particle { position = p, mass = 1 } end
    local bead = scene:particle { position = { r0, 0, 0 }, velocity = { 0, r0 * w, 0 }, mass = m }
    scene:pin { ends[1], ends[2] }
    scene:pin({ ends[3] }, { path = function(s) return -0.5 * math.sin(w * s), 0.5 * math.cos(w * s) - 0.5, 0 end })
    scene:constraint("guides", { points = { { ends[1], bead, ends[2], ends[3] } } })
    local s = scene:run():state()
    local p = s:position(bead)
    return { math.sqrt(p[1] ^ 2 + p[2] ^ 2), s:constraint_forces("guides")[1] }
  end,
}
