-- A chain of 2 m hangs between hooks 1.6 m apart: of all curves the catenary has the least potential energy. Half of it, from its
-- lowest point, is the way of a point that goes along it at 1 m/s; the control is the curvature.
local numerics = require("numerics")
local validation = require("validation")

local half, span = 1, 0.8 -- m

-- c sinh(span/c) = half, by bisection.
local function parameter()
  return numerics.root(function(c) return c * (math.exp(span / c) - math.exp(-span / c)) / 2 - half end, 0.3, 3)
end

-- z = sqrt(c^2 + s^2) - c: the integral over s of z less what it is at the hook.
local function energy()
  local c = parameter()
  local top = math.sqrt(c * c + half * half)
  return (half * top + c * span) / 2 - half * top
end

return validation.problem {
  title = "A hanging chain by the least potential energy",
  quantities = {
    { name = "energy of a half", unit = "m^2", reference = energy,
      source = "closed form: the catenary (Bernoulli, Leibniz and Huygens, 1691), below the hooks, by weight per length" },
  },
  space = { 70, 140, 280 },
  space_label = "1/frames",
  tolerance = 1e-6,
  why = "the trapezium rule over frames has an error of order 2, 1e-6 at the finest level, extrapolated; 11 knots cost 1e-8",
  quick = false,
  asks = function(at)
    return { command = "optimise", words = { "fps=" .. at.n }, script = [[
      local scene = hooke.scene { duration = 1, fps = param("fps", 70), integrator = "rk4" }
      local start = {}
      for k = 1, 11 do start[k] = 0.5 end
      local curvature = scene:control("curvature", { knots = 11, start = start, help = "1/m" })
      local p = scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 } }
      scene:force("field", { f = function(t, _, _, _, vx, _, vz)
        local k = curvature(t)
        return -k * vz, 0, k * vx
      end })
      scene:measure("x", function(s) return s:position(p)[1] end)
      scene:goal { measure = "x", value = 0.8 }
      scene:cost(function(s) return -s.t * s:velocity(p)[3] end) -- by parts
      return scene]] }
  end,
  solve = function(at) return at.found.optima[1].cost end,
}
