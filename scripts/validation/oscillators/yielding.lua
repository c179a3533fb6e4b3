-- A mass thrown against a spring that yields: an elastic stretch, a plastic one with the stiffness k H/(k + H), and then an
-- oscillation about the plastic elongation g whose amplitude is what the spring can bear, (f_y + H g)/k.
local validation = require("validation")

local k, yield, H, v, t_end = 100, 0.05, 25, 3, 0.5 -- N/m, -, N/m, m/s, s; 1 kg, 1 m
local f = k * yield
local w, flowing = math.sqrt(k), k * H / (k + H)
local slow = math.sqrt(flowing)

-- When it yields and how fast it is then; when it turns, and where.
local t_yield = math.asin(w * yield / v) / w
local v_yield = math.sqrt(v * v - w * w * yield * yield)
local t_turn = t_yield + math.atan(v_yield * slow / f) / slow
local x_turn = yield + (math.sqrt(f * f / flowing + v_yield * v_yield) * slow - f) / flowing
local g = (k * (x_turn - yield)) / (k + H)
local function exact(t) return g + (f + H * g) / k * math.cos(w * (t - t_turn)) end

return validation.problem {
  title = "Mass thrown against a spring that yields",
  quantities = {
    { name = "x at t = 0.5 s", unit = "m", reference = exact(t_end), scale = x_turn,
      source = "closed form, piecewise linear (Simo and Hughes 1998, box 1.4)" },
  },
  time = { 4e-3, 2e-3, 1e-3, 5e-4 },
  order = { time = 2 },
  tolerance = 1e-4,
  why = "(w h)^2/24 w t = 5e-6 at the finest step; the step in which the spring yields adds (w h)^3, which no order describes",
  forces = { plastic_springs = { "edges", "k", "yield", "hardening" } },
  quick = { time = { 8e-3, 4e-3, 2e-3 }, tolerance = 1e-3 },
  solve = function(at)
    local scene = hooke.scene { duration = t_end, fps = 2, dt = at.h, integrator = "leapfrog" }
    local anchor = scene:particle { position = { 0, 0, 0 }, mass = 1 }
    local p = scene:particle { position = { 1, 0, 0 }, velocity = { v, 0, 0 }, mass = 1 }
    scene:pin { anchor }
    scene:force("plastic_springs", { edges = { { anchor, p } }, k = k, yield = yield, hardening = H })
    return scene:run():state():position(p)[1] - 1
  end,
}
