-- Limits of h w known in closed form, at several ratios of the damping to the critical one.
local oscillator_theory = {}

oscillator_theory.ratios = { 0, 0.01, 0.1, 0.5, 1, 2, 10 } -- damping over critical damping, xi = g/(2 w)

-- |R(z)| of a Runge-Kutta method at the two roots z of z^2 + hg z + hw^2 = 0, R(z) = sum c_k z^k.
local function polynomial(c)
  local function size(re, im)
    local a, b = 0, 0
    for k = #c, 1, -1 do a, b = a * re - b * im + c[k], a * im + b * re end
    return math.sqrt(a * a + b * b)
  end
  return function(hw, hg)
    local d = hg * hg / 4 - hw * hw
    if d < 0 then return size(-hg / 2, math.sqrt(-d)) end
    local fast = -hg / 2 - math.sqrt(d)
    return math.max(size(fast, 0), fast < 0 and size(hw * hw / fast, 0) or 0)
  end
end

local function runge_kutta(c)
  return function(limits_of) return limits_of(polynomial(c)) end
end

local function at_ratios(f)
  return function()
    local list = {}
    for k, ratio in ipairs(oscillator_theory.ratios) do list[k] = f(ratio) end
    return list
  end
end

-- s (h w)^2 + d h g = 4
local function recurrence(s, d)
  return at_ratios(function(x) return (math.sqrt(d * d * x * x + 4 * s) - d * x) / s end)
end

local any = at_ratios(function() return math.huge end)
local root = math.sqrt
local dormand_prince = runge_kutta { 1, 1, 1 / 2, 1 / 6, 1 / 24, 1 / 120, 1 / 600 }

-- Closed forms: Hairer and Wanner, Solving ODEs II, IV.2 and IV.3 (one-step methods, by their stability functions),
-- V.1 (BDF); the recurrences of leapfrog (with the velocity predicted, v + h a) and symplectic Euler at the root -1;
-- Hairer, Norsett and Wanner, Solving ODEs I, III.10 (Stoermer), at -1: 4 = (h w)^2 sum sigma_j 2^j + 2 h g sum gamma_j 2^j.
local theory = {
  euler = at_ratios(function(x) return x < 1 and 2 * x or 2 / (x + root(x * x - 1)) end),
  symplectic_euler = at_ratios(function(x) return 2 * (root(1 + x * x) - x) end),
  leapfrog = at_ratios(function(x) return 2 * (root(1 + 4 * x * x) - 2 * x) end),
  midpoint = runge_kutta { 1, 1, 1 / 2 },
  trapezoid = runge_kutta { 1, 1, 1 / 2 },
  rk4 = runge_kutta { 1, 1, 1 / 2, 1 / 6, 1 / 24 },
  dopri5 = dormand_prince,
  arkode = dormand_prince,
  stoermer = function() return { root(2) } end,
  stoermer_wide2 = recurrence(1, 1.376),
  stoermer_wide3 = recurrence(1 + 1 / 3 - 0.16, 2 * (2 + 5 / 3 - 8 * 0.66 + 16 * 0.17)),
  stoermer_wide4 = recurrence(2 - 16 * 0.004 - 32 * 0.015, 2 * (5 + 5 / 3 - 16 * 0.67 + 32 * 0.18)),
  backward_euler = any,
  implicit_midpoint = any,
  implicit_trapezoid = any,
  bdf2 = any,
  tr_bdf2 = any,
  esdirk4 = any,
  imex = any,
  baraff_witkin = any,
  local_global = any,
  xpbd = any,
}

-- The limits of a method in the order of the ratios (perhaps of the first only); nil where there is none.
-- limits_of(growth): the search for limits on a function (hw, hg) -> growth.
function oscillator_theory.limits(name, limits_of) return theory[name] and theory[name](limits_of) end

return oscillator_theory
