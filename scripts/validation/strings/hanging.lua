-- An elastic string hangs from one end, longer by w L^2/(2 EA) than it lies, and swings along itself about that length: a
-- bar that is fixed at one end, with the period 4 L sqrt(mu/EA). Springs with lumped masses, half of one at the tip, have
-- that stretch for any n.
local validation = require("validation")

local EA, mu, L, g, swings = 20, 0.3, 1.2, 9.81, 3
local w, c = mu * g, math.sqrt(EA / mu)

return validation.problem {
  title = "A string hangs and swings along itself",
  quantities = {
    { name = "stretch at rest", unit = "m", reference = w * L * L / (2 * EA), source = "closed form, w L^2/(2 EA)",
      tolerance = 1e-11, why = "exact for lumped masses: what is left of the motion", order = {} },
    { name = "period", unit = "s", reference = 4 * L / c, source = "closed form, 4 L sqrt(mu/EA)" },
  },
  space = { 8, 16, 32 },
  time = { 0.004, 0.002, 0.001 },
  order = { space = 2, time = 2 },
  noise = 1e-11,
  tolerance = 2e-6,
  why = "errors of order 2, 1e-4 at n = 32, leave those of order 4, (pi/64)^4/1920 and the like",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 4, 8, 16 }, time = { 0.008, 0.004, 0.002 }, tolerance = 1e-3 },
  solve = function(at)
    local n, l = at.n, L / at.n
    -- The string at rest, every segment longer by the weight below its middle, and swinging by its first mode.
    local function string(duration, fps, dt, speed, drag)
      local scene = hooke.scene { duration = duration, fps = fps, dt = dt, integrator = "leapfrog" }
      local ids, edges = {}, {}
      for k = 0, n do
        local s = k * l
        ids[k] = scene:particle { position = { 0, 0, -s - w * (L * s - s * s / 2) / EA }, mass = mu * l * (k == n and 0.5 or 1),
          velocity = { 0, 0, -speed * math.sin(math.pi * k / (2 * n)) } }
        if k > 0 then edges[k] = { ids[k - 1], ids[k] } end
      end
      scene:pin { ids[0] }
      scene:force("gravity", { g = { 0, 0, -g } })
      scene:force("drag", { rate = drag })
      scene:force("springs", { edges = edges, k = EA / l, rest = l })
      return scene, ids
    end
    local scene, ids = string(60, 1, at.h, 0.1, 5)
    local stretch = -validation.rest(scene, 1, 1e-12, 60):state():position(ids[n])[3] - L
    local steps = math.ceil((swings + 0.1) * 4 * L / c / at.h)
    scene, ids = string(steps * at.h, validation.fps(at.h), at.h, 0.01, 0)
    local falls = validation.crossings(-1)
    validation.each(scene, at.h, steps, function(s, t)
      if t > 0 then falls(t, s:position(ids[n])[3] + L + stretch, s:velocity(ids[n])[3]) end
    end)
    return { stretch, (falls.times[#falls.times] - falls.times[1]) / (#falls.times - 1) }
  end,
}
