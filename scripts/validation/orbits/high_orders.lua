-- Kepler's ellipse of eccentricity 0.6 by the methods of order 8, which are for orbits to many digits. h is the
-- step of the multistep method; a composition takes as many evaluations a step as it has parts, and a longer step.
local validation = require("validation")

local t_end = 10
local methods = { { "kahan_li8", 8, 17 }, { "stoermer8", 8, 2 } } -- name, order, step over h

local quantities = {}
for k, m in ipairs(methods) do
  quantities[k] = { name = ("x at t = 10 s, %s"):format(m[1]), unit = "m", reference = -1.5350235919098137,
    order = { time = m[2], within = 1 }, source = "Kepler's equation E - e sin E = t, solved to rounding" }
end

return validation.problem {
  title = "Kepler's ellipse by methods of order 8",
  quantities = quantities,
  time = { 1 / 200, 1 / 300, 1 / 400 },
  tolerance = 1e-9,
  noise = 1e-11,
  why = "errors of order 8 at the finest step, of which terms of the next order are left",
  forces = { central = { "strength", "power" } },
  quick = { time = { 1 / 150, 1 / 200, 1 / 300 }, tolerance = 1e-6 },
  solve = function(at)
    local found = {}
    for k, m in ipairs(methods) do
      local scene = hooke.scene { duration = t_end, fps = 2, dt = at.h * m[3], integrator = m[1] }
      local p = scene:particle { position = { 0.4, 0, 0 }, velocity = { 0, 2, 0 }, mass = 1 }
      scene:force("central", { strength = 1, power = -2 })
      found[k] = scene:run():state():position(p)[1]
    end
    return found
  end,
}
