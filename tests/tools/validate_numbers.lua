-- What validation rests on, against numbers known from elsewhere: the mathematics of references (scripts/lib/numerics.lua),
-- the interpolations of measuring (scripts/lib/validation.lua), and orders and limits of made-up series
-- (tools/common/validate/convergence.lua).
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
package.path = ("%s/scripts/lib/?.lua;%s/tools/?.lua;"):format(root, root) .. package.path
local convergence = require("common.validate.convergence")
local numerics = require("numerics")
local validation = require("validation")

local failed = 0
local function near(what, value, wanted, tolerance)
  local off = math.abs(value - wanted) / math.max(math.abs(wanted), 1e-300)
  if off <= tolerance then return end
  failed = failed + 1
  print(("%s: %.17g instead of %.17g, off by %.1e"):format(what, value, wanted, off))
end

-- Abramowitz and Stegun, tables 17.1, 17.2 and 9.5, with more digits by arithmetic of 50; a few roundings each.
near("K(sin 45)", numerics.ellipk(math.sin(math.rad(45))), 1.85407467730137192, 1e-15)
near("K(sin 89)", numerics.ellipk(math.sin(math.rad(89)), math.cos(math.rad(89))), 5.43490982962556352, 1e-14)
near("E(sin 45)", numerics.ellipe(math.sin(math.rad(45))), 1.35064388104767550, 1e-14)
near("E(0)", numerics.ellipe(0), math.pi / 2, 1e-15)
near("F(30 degrees, sin 45)", numerics.ellipf(math.rad(30), math.sin(math.rad(45))), 0.53562273280540331, 1e-13)
near("j01", numerics.bessel_zero(0, 1), 2.40482555769577277, 1e-14)
near("j03", numerics.bessel_zero(0, 3), 8.65372791291101222, 1e-14)
near("j12", numerics.bessel_zero(1, 2), 7.01558666981561875, 1e-14)
near("J2(3)", numerics.bessel_j(2, 3), 0.48609126058589107, 1e-13)
near("int of 1/sqrt x", numerics.integrate(function(x) return 1 / math.sqrt(x) end, 0, 1), 2, 1e-12)
near("int of 1/sqrt(1 - x), by the distance to the end",
  numerics.integrate(function(x, d) return 1 / math.sqrt(x > 0.5 and d or 1 - x) end, 0, 1), 2, 1e-12)
near("root of cos", numerics.root(math.cos, 1, 2), math.pi / 2, 1e-15)
local swing = numerics.ode(function(_, y) return { y[2], -y[1] } end, 0, { 1, 0 }, 20)
near("cos 20", swing[1], math.cos(20), 1e-12)
near("exp(5 t), backwards", numerics.ode(function(_, y) return { 5 * y[1] } end, 1, { math.exp(5) }, 0)[1], 1, 1e-12)

-- A cubic is interpolated exactly.
local function cubic(t) return (t - 0.3) * (t * t + 1), 3 * t * t - 0.6 * t + 1 end
local y0, s0 = cubic(0)
local y1, s1 = cubic(1)
near("zero of a cubic", validation.zero_between(0, y0, s0, 1, y1, s1), 0.3, 1e-14)
near("value of a cubic", validation.cubic(0.7, 0, y0, s0, 1, y1, s1), (cubic(0.7)), 1e-14)
local rises = validation.crossings(1)
for k = 0, 700 do rises(0.01 * k, math.sin(0.01 * k + 1), math.cos(0.01 * k + 1)) end
near("number of rising zeros", #rises.times, 1, 0)
near("rising zero of sin(t + 1)", rises.times[1], 2 * math.pi - 1, 1e-11) -- h^4/384
near("bisection", validation.bisect(function(x) return x * x - 2 end, 1, 2, 1e-12), math.sqrt(2), 1e-12)

-- v = 7 + C h^p at any levels.
for _, case in ipairs { { { 4, 2, 1 }, 2 }, { { 1, 0.7, 0.1 }, 1.5 }, { { 0.5, 0.4, 0.3, 0.2 }, 4 } } do
  local h, p, v = case[1], case[2], {}
  for k, x in ipairs(h) do v[k] = 7 - 0.3 * x ^ p end
  local found = convergence.of(h, v, 1e-13)
  near("order " .. p, found.order, p, 1e-9)
  near("limit, order " .. p, found.value, 7, 1e-12)
end
local exact = convergence.of({ 4, 2, 1 }, { 7, 7 + 1e-14, 7 }, 1e-13)
assert(exact.exact and not exact.order and not exact.doubt)
local once = convergence.of({ 4, 2, 1 }, { 7.16, 7, 7 }, 1e-3) -- 0.16, then below 0.001: an order above ln 160/ln 2
near("least order", once.at_least, math.log(160, 2), 1e-9)
assert(convergence.of({ 4, 2, 1 }, { 7, 8, 7.5 }, 1e-13).doubt:find("back and forth"))
assert(convergence.of({ 4, 2, 1 }, { 7, 8, 10 }, 1e-13).doubt:find("fit no order"))
-- The finest levels differ by rounding only: the order is that of the others, and nothing is extrapolated.
local late = convergence.of({ 8, 4, 2, 1 }, { 7.64, 7.16, 7.04, 7.04 }, 1e-3)
near("order before the noise", late.order, 2, 1e-9)
near("value in the noise", late.value, 7.04, 0)
-- Components of a vector, one of which passes zero: the order is that of the length.
local h, one, other = { 4, 2, 1 }, {}, {}
for k, x in ipairs(h) do one[k], other[k] = 3 * x ^ 2, -2 * x ^ 2 end
local common = convergence.together(h, { one, other }, 1e-13)
near("order of a vector", common.order, 2, 1e-9)
assert(math.abs(convergence.limit(h, one, common)) < 1e-12)

-- Errors of two known orders: extrapolation of the first alone leaves the second. Of unequal ratios too.
local study = require("common.validate.study")
for _, n in ipairs { { 8, 16, 32 }, { 8, 12, 24 } } do
  for _, second in ipairs { 3, 4 } do
    local cells = {}
    for k, size in ipairs(n) do
      cells[k] = { space = k, values = { 7 + 3 / size ^ 2 - 2 / size ^ second } }
    end
    local function value(order)
      local q = { name = "v", reference = 7, scale = 7, tolerance = 1, noise = 1e-14, order = order }
      return study.results({ quantities = { q } }, { space = n }, cells, false)[1].value
    end
    assert(math.abs(value { space = 2, within = 1 } - 7) > 1e-7)
    assert(math.abs(value { space = 2, space_next = second, within = 1 } - 7) < 1e-12)
    -- An order that the levels do not show is not believed.
    assert(value { space = 3, space_next = 4, within = 0.1 } == value { space = 3, within = 0.1 })
  end
end
near("digits", convergence.digits(1.001, 1, 1), 3, 1e-12)
near("digits of equals", convergence.digits(1, 1, 1), 16, 0)

if failed > 0 then os.exit(1) end
print("passed")
