-- A spring, damped along its length, is let go: x'' = -w^2 x - 2 d x'. Every method of constant step that the problems
-- beside this one leave out comes to the same place, with an error of its order; those that choose their steps by a
-- tolerance, with an error of its size. h is the step of methods of order 2; others take a part of it or a multiple, so
-- that the errors at the finest step are alike.
local validation = require("validation")

local w, d, t_end = 2 * math.pi, 0.25, 2.25

local function exact(t)
  local wd = math.sqrt(w * w - d * d)
  return math.exp(-d * t) * (math.cos(wd * t) + d / wd * math.sin(wd * t))
end

-- name, order, step over h, tolerance relative to the swing and why; `tol` of those that choose their steps.
local chosen, high = "some thousands of `tol`, or more at order 2", "terms of the next orders are left"
local order_1, order_2 = "a term of order 2 is left of order 1", "terms of order 3 and 4 are left of order 2"
local methods = {
  { "desbrun", 1, 1 / 8, 1e-4, order_1 },
  { "baraff_witkin", 1, 1 / 8, 1e-4, order_1 },
  { "local_global", 1, 1 / 8, 1e-4, order_1 },
  { "midpoint", 2, 1, 1e-5, order_2 },
  { "trapezoid", 2, 1, 1e-5, order_2 },
  { "implicit_trapezoid", 2, 1, 1e-5, order_2 },
  { "imex", 2, 1, 1e-5, order_2 },
  { "local_leapfrog", 2, 1, 1e-5, order_2 },
  { "stoermer_wide2", 2, 1, 1e-5, order_2 },
  { "stoermer_wide3", 3, 2, 1e-5, high },
  { "stoermer_wide4", 4, 4, 1e-5, high },
  { "stoermer", 4, 4, 1e-5, high },
  { "stoermer5", 5, 2, 1e-5, high },
  { "linear_bdf2", nil, nil, 1e-3, chosen, 1e-8 },
  { "tr_bdf2", nil, nil, 1e-4, chosen, 1e-8 },
  { "esdirk4", nil, nil, 1e-6, chosen, 1e-9 },
}
for _, name in ipairs { "arkode", "cvode" } do -- where hooke is built with SUNDIALS
  if pcall(hooke.scene, { integrator = name }) then methods[#methods + 1] = { name, nil, nil, 1e-6, chosen, 1e-9 } end
end

local quantities = {}
for k, m in ipairs(methods) do
  quantities[k] = { name = ("x at t = 2.25 s, %s"):format(m[1]), unit = "m", reference = exact(t_end),
    scale = math.exp(-d * t_end), order = { time = m[2], within = 0.3 }, tolerance = m[4], why = m[5],
    source = "closed form, exp(-d t)(cos wd t + d/wd sin wd t)" }
end

local function swing(m, h)
  local scene = hooke.scene { duration = t_end, fps = 4, dt = m[3] and h * m[3], tol = m[6], integrator = m[1] }
  local anchor = scene:particle { position = { -2, 0, 0 }, mass = 1 }
  local p = scene:particle { position = { 1, 0, 0 }, mass = 1 }
  scene:pin { anchor }
  scene:force("springs", { edges = { { anchor, p } }, k = w * w, rest = 2, damping = 2 * d })
  return scene:run():state():position(p)[1]
end

return validation.problem {
  title = "A damped spring by methods of constant and of chosen steps",
  quantities = quantities,
  time = { 0.01, 0.005, 0.0025, 0.00125 },
  noise = 1e-9,
  forces = { springs = { "edges", "k", "rest", "damping" } },
  quick = { time = { 0.01, 0.005, 0.0025 }, tolerance = 1e-2 },
  solve = function(at)
    local found = {}
    for k, m in ipairs(methods) do found[k] = swing(m, at.h) end
    return found
  end,
}
