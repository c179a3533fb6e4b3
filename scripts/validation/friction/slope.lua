-- A block on a slope of tan a = 1/2: below mu = 1/2 it slides with g (sin a - mu cos a), above it stays.
local validation = require("validation")

local g, a = 9.81, math.atan(0.5)
local t_end = 2

local function way(mu) return g * (math.sin(a) - mu * math.cos(a)) * t_end ^ 2 / 2 end

return validation.problem {
  title = "A block on a slope of tan a = 1/2",
  quantities = {
    { name = "way in 2 s, mu = 0.3", unit = "m", reference = way(0.3), source = "Coulomb: g (sin a - mu cos a) t^2/2" },
    { name = "way in 2 s, mu = 0.49", unit = "m", reference = way(0.49), source = "Coulomb: g (sin a - mu cos a) t^2/2" },
    { name = "way in 2 s, mu = 0.51", unit = "m", reference = 0, scale = way(0.49), source = "Coulomb: it sticks" },
  },
  time = { 0.02, 0.01, 0.005 },
  tolerance = 1e-11,
  noise = 1e-11,
  why = "the force is constant, so that every step is exact but for rounding",
  quick = { time = { 0.1, 0.05, 0.02 }, tolerance = 1e-11 },
  solve = function(at)
    local found = {}
    for i, mu in ipairs { 0.3, 0.49, 0.51 } do
      local scene = hooke.scene { duration = t_end, fps = 10, dt = at.h, integrator = "leapfrog" }
      local p = scene:particle { position = { 0, 0, 0 }, mass = 2 }
      scene:force("gravity", { g = { 0, 0, -g } })
      scene:corrector("obstacle", { normal = { -math.sin(a), 0, math.cos(a) }, friction = mu })
      local x = scene:run():state():position(p)
      found[i] = -x[1] * math.cos(a) - x[3] * math.sin(a)
    end
    return found
  end,
}
