-- The numbers of hooke fit without runs (tools/common/fit): linear regression, whose answer and covariance are known; the
-- decomposition and singular values against closed forms; curves with noise, whose deviations have to be those of the
-- fits; what the data do not determine; bounds; starts.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
package.path = ("%s/tools/?.lua;"):format(root) .. package.path
local fitting = require("common.fit.fitting")
local least_squares = require("common.fit.least_squares")
local linear = require("common.fit.linear")
local statistics = require("common.fit.statistics")

local function near(what, x, wanted, tolerance)
  assert(math.abs(x - wanted) <= tolerance, ("%s: %.17g instead of %.17g"):format(what, x, wanted))
end

-- A fit of y(t, p) to numbers, as fitting.from asks for it. `by_step(t)`: what half the step changes, a quarter of the
-- change of the step before.
local function fit(y, start, t, measured, options)
  local o = { tolerance = 1e-7, accuracy = 1e-6, most = 60, weighted = options and options.weighted, low = {}, high = {}, scale = {} }
  local error_of = options and options.by_step or function() return 0 end
  o.runs = { level = 0, residuals = function(self, points, _, level)
    local list = {}
    for k, p in ipairs(points) do
      list[k] = {}
      for i = 1, #t do
        list[k][i] = (y(t[i], p) + error_of(t[i]) / 4 ^ (level or self.level) - measured[i]) / (o.weighted or 1)
      end
    end
    return list, {}
  end }
  for j = 1, #start do
    o.low[j], o.high[j] = options and options.low or -math.huge, options and options.high or math.huge
    o.scale[j] = start[j] ~= 0 and 1e-3 * math.abs(start[j]) or 1e-3
  end
  return assert(fitting.from(start, o)), o
end

-- ---- matrices ----

-- Hilbert's matrix of 4: the product of its singular values is its determinant, 1/6048000.
local hilbert = {}
for j = 1, 4 do
  hilbert[j] = {}
  for i = 1, 4 do hilbert[j][i] = 1 / (i + j - 1) end
end
local product = 1
for _, part in ipairs(linear.singular(hilbert)) do product = product * part.value end
near("determinant", product * 6048000, 1, 1e-11) -- condition 1.6e4
local x = linear.least_squares(hilbert, { 25 / 12, 77 / 60, 57 / 60, 319 / 420 }, { 0, 0, 0, 0 })
for k = 1, 4 do near("solution", x[k], 1, 1e-11) end
near("triangle", math.abs(linear.triangle { { 3, 4, 0 }, { 1, 0, 7 } }[1][1]), 5, 1e-14)

-- ---- linear regression: y = a + b t ----

local t, measured, n = {}, {}, 40
for k = 1, n do t[k], measured[k] = k / 10, 2 - 3 * k / 10 + 0.01 * math.sin(37 * k * k) end
local st, stt, sy, sty = 0, 0, 0, 0
for k = 1, n do st, stt, sy, sty = st + t[k], stt + t[k] ^ 2, sy + measured[k], sty + t[k] * measured[k] end
local determinant = n * stt - st * st
local a, b = (stt * sy - st * sty) / determinant, (n * sty - st * sy) / determinant
local rest = 0
for k = 1, n do rest = rest + (measured[k] - a - b * t[k]) ^ 2 end
local function straight(time, p) return p[1] + p[2] * time end
local line = fit(straight, { 1, 1 }, t, measured)
local variance = rest / (n - 2)
near("a", line.p[1], a, 1e-9)
near("b", line.p[2], b, 1e-9)
-- differences of a straight line are exact but for rounding, 1e-16/1e-5
near("deviation of a", line.sd[1] / math.sqrt(variance * stt / determinant), 1, 1e-8)
near("deviation of b", line.sd[2] / math.sqrt(variance * n / determinant), 1, 1e-8)
near("correlation", line.correlation[1][2], -st / math.sqrt(n * stt), 1e-8)
local weighted = fit(straight, { 1, 1 }, t, measured, { weighted = 0.2 })
near("known deviations", weighted.sd[2] / (0.2 * math.sqrt(n / determinant)), 1, 1e-8)

-- ---- a damped oscillation with noise: 200 seeds ----

local function oscillation(time, p)
  local g = p[2] / 2
  local w = math.sqrt(p[1] - g * g)
  return math.exp(-g * time) * (math.cos(w * time) + g / w * math.sin(w * time))
end
local function gauss() return math.sqrt(-2 * math.log(1 - math.random())) * math.cos(2 * math.pi * math.random()) end
math.randomseed(1)
local sum, said, seeds = { 0, 0 }, { 0, 0 }, 200
for _ = 1, seeds do
  for k = 1, n do measured[k] = oscillation(t[k], { 9, 0.4 }) + 0.02 * gauss() end
  local found = fit(oscillation, { 8, 0.3 }, t, measured)
  for j, truth in ipairs { 9, 0.4 } do
    sum[j] = sum[j] + (found.p[j] - truth) ^ 2
    said[j] = said[j] + found.sd[j] ^ 2
  end
end
-- the deviation of 200 numbers is known to 1/sqrt(400) of itself, one deviation
for j = 1, 2 do near("spread over the seeds, by the deviations said", math.sqrt(sum[j] / said[j]), 1, 3 / math.sqrt(400)) end

-- ---- what is not determined ----

for k = 1, n do measured[k] = oscillation(t[k], { 9, 0.4 }) end
local pair = fit(function(time, p) return oscillation(time, { p[1] / p[2], 0.4 }) end, { 16, 2 }, t, measured)
near("k/m", pair.p[1] / pair.p[2], 9, 1e-6)
assert(#pair.blind == 1 and #pair.blind[1] == 2)
near("changed together", pair.blind[1][1][2] / pair.blind[1][2][2], 1, 1e-5)
assert(pair.sd[1] ~= pair.sd[1] and pair.sd[2] ~= pair.sd[2])
local idle = fit(function(time, p) return oscillation(time, { p[1], 0.4 }) end, { 8, 5 }, t, measured)
assert(#idle.blind == 1 and idle.blind[1][1][1] == 2 and idle.sd[2] ~= idle.sd[2] and idle.sd[1] == idle.sd[1])

-- ---- a bound, and steps that matter ----

local bounded = fit(straight, { 1, 1 }, t, { table.unpack(t) }, { low = 0.5, high = 3 })
near("at the bound", bounded.p[1], 0.5, 0)
near("the other one", bounded.p[2], 1 - 0.5 * st / stt, 1e-9)
-- A step that changes y by 1e-3 t has b off by 1e-3; it is refined until half of it moves b by less than 5e-7.
local refined = fit(straight, { 1, 1 }, t, { table.unpack(t) }, { by_step = function(time) return 1e-3 * time end })
assert(refined.level == 6, refined.level) -- 2 (1/4^5 - 1/4^6) 1e-3 > 1e-6
near("what it says of the steps", refined.by_steps[2], 1.5e-3 / 4 ^ 6, 1e-9)
near("b with refined steps", refined.p[2], 1, refined.by_steps[2])

-- ---- residuals in a row, starts ----

near("in a row", statistics.serial_correlation({ 1, 1, 1, 1 }, { "y", "y", "y", "y" }), 0.75, 1e-15)
near("of two kinds", statistics.serial_correlation({ 1, -1, 1, -1 }, { "x", "y", "x", "y" }), 0.5, 1e-15)
local starts = fitting.starts(3, { 0, 1 }, { 1, 1e4 })
near("half", starts[1][1], 0.5, 1e-15)
near("a third of the logarithm", starts[1][2], 1e4 ^ (1 / 3), 1e-9)
near("a quarter", starts[2][1], 0.25, 1e-15)

-- ---- how many runs a fit takes ----

-- A sag that falls with the stiffness, from 15 % and from a factor of two off: a run at the start, two for the first
-- difference, then one an iteration, which the secant needs, to 1e-6. By four parameters the differences of every iteration
-- would take 8 runs each: 83 in all, with updates 53.
local function runs_of(y, start, truth, times)
  local counted, wanted = 0, {}
  for k = 1, times do wanted[k] = y(3 * k / times, truth) end
  local problem = { start = start, low = {}, high = {}, scale = {}, difference = 1e-5, tolerance = 1e-6, most = 60 }
  for j = 1, #start do problem.low[j], problem.high[j], problem.scale[j] = -math.huge, math.huge, 1e-3 * start[j] end
  function problem.evaluate(points)
    local list = {}
    for k, p in ipairs(points) do
      counted, list[k] = counted + 1, {}
      for i = 1, times do list[k][i] = y(3 * i / times, p) - wanted[i] end
    end
    return list, {}
  end
  local state = assert(least_squares.solve(problem))
  for j, wish in ipairs(truth) do near("parameter", state.p[j] / wish, 1, 1e-6) end
  return counted
end
local function sag(_, p) return -1 / p[1] ^ 0.7 end
assert(runs_of(sag, { 1.15 }, { 1 }, 1) <= 9)
assert(runs_of(sag, { 2 }, { 1 }, 1) <= 13)
local function decay(time, p) return p[1] * math.exp(-p[2] * time) + p[3] * math.exp(-p[4] * time) end
assert(runs_of(decay, { 1, 1, 2, 4 }, { 1.5, 0.7, 1, 3 }, 40) <= 60)
