-- Huygens' pendulum: a bead slides down a cycloid, x = a (p + sin p), z = a (1 - cos p), from rest at three heights, and
-- reaches the bottom after the same time from all of them. The curve is two functions of the script.
local validation = require("validation")

local a, g = 0.25, 9.81

-- p of the cycloid's point above x, by Newton's iteration: p + sin p rises for |p| < pi
local function angle(x)
  local p = x / (2 * a)
  for _ = 1, 50 do
    local step = (p + math.sin(p) - x / a) / (1 + math.cos(p))
    p = p - step
    if math.abs(step) < 1e-15 then break end
  end
  return p
end

local starts, quantities = { 0.2, 1, 2.2 }, {}
for k, p in ipairs(starts) do
  quantities[k] = { name = ("time from %.3g m"):format(a * (1 - math.cos(p))), unit = "s",
    reference = math.pi * math.sqrt(a / g), source = "closed form, pi sqrt(a/g) (Huygens, Horologium oscillatorium, 1673)" }
end

return validation.problem {
  title = "Tautochrone: from three heights to the bottom of a cycloid",
  quantities = quantities,
  time = { 0.02, 0.01, 0.005, 0.0025 },
  order = { time = 2 },
  tolerance = 1e-7,
  why = "errors of order 2 leave those of order 4: (w h)^4 = 1.5e-8 at the finest step, and some times that on the bends",
  quick = { time = { 0.04, 0.02, 0.01 }, tolerance = 1e-3 },
  solve = function(at)
    local steps = math.ceil(0.6 / at.h)
    local scene = hooke.scene { duration = steps * at.h, fps = validation.fps(at.h), dt = at.h, integrator = "leapfrog" }
    local beads, bottom = {}, {}
    for k, p in ipairs(starts) do
      beads[k] = scene:particle { position = { a * (p + math.sin(p)), 0, a * (1 - math.cos(p)) }, mass = 0.1 }
      bottom[k] = validation.crossings()
    end
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:constraint("surface", { particles = beads,
      g = function(_, x, _, z) return z - a * (1 - math.cos(angle(x))) end,
      g_gradient = function(_, x) return -math.tan(angle(x) / 2), 0, 1 end,
      h = function(_, _, y) return y end,
      h_gradient = function() return 0, 1, 0 end })
    validation.each(scene, at.h, steps, function(s, t)
      for k, bead in ipairs(beads) do bottom[k](t, s:position(bead)[1], s:velocity(bead)[1]) end
    end)
    local times = {}
    for k in ipairs(beads) do times[k] = bottom[k].times[1] end
    return times
  end,
}
