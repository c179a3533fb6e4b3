-- A ball falls 1 m and bounces with e = 0.8: its height after 2 s (four impacts), and the speed just before the landings
-- have lost nine tenths, both by the closed form; and that it lies still after sqrt(2 H/g) (1 + e)/(1 - e).
local validation = require("validation")

local g, H, e = 9.81, 1, 0.8
local fall = math.sqrt(2 * H / g)
local total = fall * (1 + e) / (1 - e)

local function height(t)
  local v = math.sqrt(2 * g * H)
  if t < fall then return H - g * t * t / 2 end
  t, v = t - fall, e * v
  while t >= 2 * v / g and v > 1e-9 do t, v = t - 2 * v / g, e * v end
  return v > 1e-9 and v * t - g * t * t / 2 or 0
end

return validation.problem {
  title = "A bouncing ball",
  quantities = {
    { name = "height after 2 s", unit = "m", reference = height(2), source = "closed form, four impacts" },
    { name = "height after 3.5 s", unit = "m", reference = height(3.5), source = "closed form, ten impacts" },
    { name = "height after all impacts", unit = "m", reference = 0, scale = 1,
      source = "closed form: it lies after sqrt(2 H/g) (1 + e)/(1 - e) = 4.06 s" },
  },
  time = { 1 / 30, 1 / 60, 1 / 120 },
  tolerance = 1e-11,
  noise = 1e-11,
  why = "parabolas are exact in every step and landings are found to rounding",
  quick = { time = { 1 / 10, 1 / 20, 1 / 40 }, tolerance = 1e-11 },
  solve = function(at)
    local scene = hooke.scene { duration = 4.5, fps = 10, dt = at.h, integrator = "leapfrog" }
    local p = scene:particle { position = { 0, 0, H }, mass = 0.1 }
    scene:force("gravity", { g = { 0, 0, -g } })
    scene:corrector("obstacle", { restitution = e })
    assert(total < 4.5)
    local found = {}
    for i, t in ipairs { 2, 3.5, 4.5 } do found[i] = scene:run { to = t }:state():position(p)[3] end
    return found
  end,
}
