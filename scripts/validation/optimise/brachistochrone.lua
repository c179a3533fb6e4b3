-- A bead on a wire falls from rest: the wire on which it gets farthest to the side in a given time is the cycloid, on which it gets
-- there in the least time, too. The control is the wire's push, which turns the velocity and does no work.
local validation = require("validation")

local g, T = 9.81, 1

return validation.problem {
  title = "Brachistochrone: the wire on which a bead gets farthest",
  quantities = {
    { name = "reach", unit = "m", reference = g * T * T / math.pi,
      source = "closed form: half an arch of the cycloid of radius R, which is pi R wide and takes pi sqrt(R/g) (Bernoulli, 1697)" },
  },
  space = { 40, 80, 160 },
  space_label = "1/frames",
  tolerance = 1e-6,
  why = "the optimum is constant in time, as controls can be; frames and steps h apart change the least cost by h^4 (the trapezium "
    .. "rule by h^2 times what the optimum is off, which grows with h^2): 1e-7 at the finest level, extrapolated",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "fps=" .. at.n }, script = [[
      local scene = hooke.scene { duration = 1, fps = param("fps", 40), integrator = "rk4" }
      local start = {}
      for k = 1, 5 do start[k] = 2 end
      local turn = scene:control("turn", { knots = 5, start = start, help = "rad/s" })
      local bead = scene:particle { position = { 0, 0, 0 } }
      scene:force("gravity", { g = { 0, 0, -9.81 } })
      scene:force("field", { f = function(t, _, _, _, vx, _, vz)
        local w = turn(t)
        return -w * vz, 0, w * vx
      end })
      scene:cost(function(s) return -s:velocity(bead)[1] end) -- its integral is the way to the side
      return scene]] }
  end,
  solve = function(at) return -at.found.optima[1].cost end,
}
