-- What one step of a method does to x'' = -x at h = 0.5: its growth and its turn, from the 2 x 2 matrix that takes the
-- state of one step to that of the next. A method with one step has the same at every step, so n, the step that is
-- looked at, must not matter.
local validation = require("validation")

local h = 0.5

-- The eigenvalue of Runge-Kutta's stability function at i h.
local function series(order)
  local re, im, term = 0, 0, 1
  for k = 0, order do
    if k > 0 then term = term * h / k end
    local sign = k % 4 < 2 and 1 or -1
    if k % 2 == 0 then re = re + sign * term else im = im + sign * term end
  end
  return math.sqrt(re * re + im * im), math.atan(im, re)
end

local rk2_growth, rk2_turn = series(2)
local rk4_growth, rk4_turn = series(4)
local methods = {
  { "euler", math.sqrt(1 + h * h), math.atan(h), "|1 + i h|" },
  { "symplectic_euler", 1, 2 * math.asin(h / 2), "2 asin(h/2)" },
  { "leapfrog", 1, 2 * math.asin(h / 2), "2 asin(h/2)" },
  { "midpoint", rk2_growth, rk2_turn, "1 + z + z^2/2 at z = i h" },
  { "trapezoid", rk2_growth, rk2_turn, "1 + z + z^2/2 at z = i h" },
  { "rk4", rk4_growth, rk4_turn, "1 + z + z^2/2 + z^3/6 + z^4/24 at z = i h" },
  { "backward_euler", 1 / math.sqrt(1 + h * h), math.atan(h), "1/(1 - i h)" },
  { "implicit_midpoint", 1, 2 * math.atan(h / 2), "(1 + i h/2)/(1 - i h/2)" },
  { "implicit_trapezoid", 1, 2 * math.atan(h / 2), "(1 + i h/2)/(1 - i h/2)" },
  -- One spring, one sweep: backward Euler, in ten substeps.
  { "xpbd", (1 + h * h / 100) ^ -5, 10 * math.atan(h / 10), "(1/(1 - i h/10))^10 (Macklin and others 2016)" },
}

local quantities = {}
for i, m in ipairs(methods) do
  quantities[2 * i - 1] = { name = m[1] .. ": growth a step", reference = m[2], source = "stability function, " .. m[4] }
  quantities[2 * i] = { name = m[1] .. ": turn a step", unit = "rad", reference = m[3],
    source = "stability function, " .. m[4] }
end

-- Along x: a spring of rest length 1 to a fixed particle.
local function states(method, count)
  local scene = hooke.scene { duration = count * h, fps = 1 / h, dt = h, integrator = method }
  local anchor = scene:particle { position = { -1, 0, 0 }, mass = 1 }
  local p = scene:particle { position = { 0.1, 0, 0 }, velocity = { 0.02, 0, 0 }, mass = 1 }
  scene:pin { anchor }
  scene:force("springs", { edges = { { anchor, p } }, k = 1, rest = 1 })
  local list = {}
  for k = 0, count do
    local s = scene:run { to = k * h }:state()
    list[k] = { s:position(p)[1], s:velocity(p)[1] }
  end
  return list
end

local function area(a, b) return a[1] * b[2] - a[2] * b[1] end

return validation.problem {
  title = "One step of each method on an oscillator",
  quantities = quantities,
  space = { 4, 8, 16 },
  space_label = "step",
  tolerance = 1e-11,
  noise = 1e-11,
  why = "rounding of x and v, which the quotient of two areas of 1e-3 enlarges",
  forces = { springs = { "edges", "k", "rest" } },
  quick = { space = { 2, 4, 8 }, tolerance = 1e-11 },
  solve = function(at)
    local found = {}
    for i, m in ipairs(methods) do
      local X, n = states(m[1], at.n + 2), at.n
      local size = area(X[n], X[n + 1])
      local det = area(X[n + 1], X[n + 2]) / size -- X[n + 2] = trace X[n + 1] - det X[n]
      local trace = area(X[n], X[n + 2]) / size
      found[2 * i - 1], found[2 * i] = math.sqrt(det), math.acos(trace / 2 / math.sqrt(det))
    end
    return found
  end,
}
