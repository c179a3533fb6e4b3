-- Mathieu's equation x'' = -(1 + eps cos 2 t) x: a swing that is pumped at twice its frequency grows. The trace of the
-- matrix that takes a start to the state a period later (2 cosh of the growth in the unstable tongue, 2 cos of the phase
-- outside of it).
local numerics = require("numerics")
local validation = require("validation")

local cases = { { 1, 0.2 }, { 2.5, 0.2 } } -- a in x'' = -(a + eps cos 2 t) x, and eps
local T = math.pi

local function trace(a, eps)
  local function f(t, y) return { y[2], -(a + eps * math.cos(2 * t)) * y[1] } end
  return numerics.ode(f, 0, { 1, 0 }, T)[1] + numerics.ode(f, 0, { 0, 1 }, T)[2]
end

local quantities = {}
local order = { 5, 4 } -- where a = 1 the phase is whole, and the term of order 4 drops out of the trace
for i, c in ipairs(cases) do
  quantities[i] = { name = ("trace of the period's map, a = %g, eps = %g"):format(c[1], c[2]), scale = 2, order = { time = order[i] },
    reference = function() return trace(c[1], c[2]) end,
    source = "recomputed by extrapolation (Gragg, Bulirsch and Stoer); tongues: Abramowitz and Stegun 20.3" }
end

return validation.problem {
  title = "Parametric resonance: Mathieu's equation",
  quantities = quantities,
  time = { T / 20, T / 40, T / 80 },
  tolerance = 1e-8,
  why = "order 4, 1e-7 at the finest step, and its tenth after extrapolation",
  quick = { time = { T / 10, T / 20, T / 40 }, tolerance = 1e-6 },
  solve = function(at)
    local found = {}
    for i, c in ipairs(cases) do
      local scene = hooke.scene { duration = T, fps = 1 / T, dt = at.h, integrator = "rk4" }
      local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }
      local q = scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 }, mass = 1 }
      scene:force("central", { power = 1, strength = function(t) return c[1] + c[2] * math.cos(2 * t) end })
      local s = scene:run():state()
      found[i] = s:position(p)[1] + s:velocity(q)[1]
    end
    return found
  end,
}
