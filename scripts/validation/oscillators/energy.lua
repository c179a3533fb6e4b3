-- What becomes of the energy of an oscillator: leapfrog keeps another quadratic form, v^2 + w^2 x^2 (1 - z^2/4) with
-- z = w h, to rounding for ever, so its energy swings by z^2/4 and does not drift; rk4, whose amplification has the square
-- 1 - z^6/72 + z^8/576, loses the part (z^5/72 - z^7/576) w t of it.
local validation = require("validation")

local w, t_end = 10, 20 -- 1/s, s; 1 kg, and 1 m at the start

local function run(integrator, h, look)
  local steps = math.floor(t_end / h + 0.5)
  local scene = hooke.scene { duration = t_end, fps = 1 / h, dt = h, integrator = integrator }
  local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }
  scene:force("central", { strength = w * w })
  validation.each(scene, h, steps, function(s) look(s:position(p)[1], s:velocity(p)[1]) end)
end

return validation.problem {
  title = "Energy of an oscillator over 32 periods",
  quantities = {
    { name = "largest change of leapfrog's own energy", reference = 0, scale = 1, order = {}, tolerance = 1e-11,
      source = "closed form, v^2 + w^2 x^2 (1 - z^2/4) (Hairer, Lubich and Wanner 2006, I.5, IX.3)",
      why = "rounding of 4,000 steps" },
    { name = "energy lost by rk4, over w t z^5", reference = 1 / 72, scale = 1 / 72,
      source = "closed form, |R(iz)|^2 = 1 - z^6/72 + z^8/576 (Hairer and Wanner 1996, IV.2)" },
  },
  time = { 2e-2, 1e-2, 5e-3 },
  order = { time = 2 },
  tolerance = 1e-3,
  noise = 1e-11,
  why = "after z^7/576 the next term, of the loss itself, is of order 5: w t z^5/144 = 4e-7 at the finest step, 4e-4 at the coarsest",
  forces = { central = { "strength" } },
  quick = { time = { 4e-2, 2e-2, 1e-2 }, tolerance = 5e-3 },
  solve = function(at)
    local z, most, last = w * at.h, 0, nil
    run("leapfrog", at.h, function(x, v)
      most = math.max(most, math.abs((v * v + w * w * x * x * (1 - z * z / 4)) / (w * w * (1 - z * z / 4)) - 1))
    end)
    run("rk4", at.h, function(x, v) last = v * v + w * w * x * x end)
    return { most, (1 - last / (w * w)) / (w * t_end * z ^ 5) }
  end,
}
