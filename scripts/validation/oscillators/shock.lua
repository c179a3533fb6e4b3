-- A half sine of force, F sin(pi t/T) until t = T, sets a mass on a spring swinging with the amplitude
-- 2 r F |cos(w T/2)|/(k |1 - r^2|), r = pi/(w T).
local validation = require("validation")

local w, T, t_end, F = 20, 0.25, 1, 30 -- 1/s, s, s, N; 1 kg
local r = math.pi / (w * T)
local size = F / (w * w * (1 - r * r))
local x_T, v_T = -size * r * math.sin(w * T), -size * r * w * (1 + math.cos(w * T))

return validation.problem {
  title = "A mass on a spring after a pulse of force",
  quantities = {
    { name = "amplitude", unit = "m", reference = 2 * r * math.abs(size * math.cos(w * T / 2)),
      source = "closed form (Clough and Penzien 1993, section 5-3; residual response to a half sine)" },
    { name = "x at t = 1 s", unit = "m",
      reference = x_T * math.cos(w * (t_end - T)) + v_T / w * math.sin(w * (t_end - T)), scale = 0.1,
      source = "closed form, free from t = T on" },
  },
  time = { 5e-3, 2.5e-3, 1.25e-3 },
  order = { time = 2 },
  tolerance = 2e-5,
  why = "errors of order 2, (w h)^2/24 w t = 5e-4 at the finest step, which leave those of order 4",
  forces = { central = { "strength" } },
  quick = { time = { 1e-2, 5e-3, 2.5e-3 }, tolerance = 5e-4 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 4, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    scene:force("central", { strength = w * w })
    scene:force("gravity", { g = function(t) return F * math.sin(math.pi * t / T), 0, 0 end, to = T, label = "pulse" })
    local s = scene:run():state()
    local x, v = s:position(p)[1], s:velocity(p)[1]
    return { math.sqrt(x * x + v * v / (w * w)), x }
  end,
}
