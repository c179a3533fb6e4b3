-- Goddard's rocket climbs as high as it can with 40 % of its mass as fuel: full thrust, a singular arc on which drag and weight are
-- in balance, and coasting. One particle's numbers: x is the height above ground and vy the mass, so that mass falls with thrust.
local validation = require("validation")

return validation.problem {
  title = "Goddard's rocket as high as it can",
  quantities = {
    { name = "height", reference = 1.01283,
      source = "Dolan, More and Munson, COPS 3.0, Argonne ANL/MCS-TM-273, 2004, problem 10; published to five decimals" },
  },
  space = { 11, 21, 41 },
  space_label = "1/knots",
  tolerance = 1e-5,
  why = "half of the fifth decimal of the reference, and 4e-6 of controls that are linear between 41 knots, where thrust jumps",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "knots=" .. at.n, "--tolerance", "1e-3" }, script = [[
      local knots = param("knots", 41)
      local duration = 0.1988 -- about that at which the rocket is highest: there height changes with its square alone
      local interval = duration / (knots - 1)
      local scene = hooke.scene { duration = duration, fps = 2 / interval, integrator = "rk4", dt = interval / 2 }
      local thrust = scene:control("thrust", { knots = knots, min = 0, max = 3.5,
        start = function(t) return t < 0.08 and 2.45 or 0.05 end })
      local p = scene:particle { position = { 0, 0, 0 }, velocity = { 0, 1, 0 } }
      scene:force("field", { f = function(t, x, _, _, v, m) -- x: above the ground, in radii of the earth; v; m: the mass
        local h, T = 1 + x, thrust(t)
        return (T - 310 * v * v * math.exp(-500 * x)) / m - 1 / (h * h), -2 * T, 0
      end })
      scene:measure("mass", function(s) return s:velocity(p)[2] end)
      scene:cost(function(s) return -s:velocity(p)[1] end) -- its integral: minus the height
      scene:goal { measure = "mass", value = 0.6 }
      return scene]] }
  end,
  solve = function(at) return 1 - at.found.optima[1].cost end,
}
