-- The numbers of hooke optimise without runs (tools/common/optimise): quadratic programs with bounds against their conditions of
-- an optimum and against all choices of active bounds; Rosenbrock's valley; costs without a least value; an evaluation that is
-- remembered to the last bit.
local root = assert(os.getenv("HK_ROOT"), "HK_ROOT: the folder of the sources")
package.path = ("%s/tools/?.lua;"):format(root) .. package.path
hooke = { create = function(path) return io.open(path, "wb") end } -- luacheck: ignore 121
local linear = require("common.fit.linear")
local quadratic = require("common.optimise.quadratic")
local sqp = require("common.optimise.sqp")

local seed = 4711
local function draw() -- Park's and Miller's
  seed = seed * 48271 % 2147483647
  return 2 * seed / 2147483647 - 1
end

local function vector(n)
  local x = {}
  for k = 1, n do x[k] = draw() end
  return x
end

-- ---- |p - a|^2 with one equation and bounds of p itself: p = clip(a + m b), m by bisection ----

local function clipped(a, b, m, low, high)
  local p = {}
  for k = 1, #a do p[k] = math.min(math.max(a[k] + m * b[k], low), high) end
  return p
end

local n, kept_some = 7, 0
local B = {}
for k = 1, n do
  B[k] = {}
  for j = 1, n do B[k][j] = k == j and 0.5 or 0 end
end
for _ = 1, 40 do
  local a, b, wanted = vector(n), vector(n), 4 * draw()
  local g, low, high = {}, -0.6, 0.7
  for k = 1, n do g[k] = -2 * a[k] end
  local bounds = { at = {}, low = {}, high = {}, values = function(p) return p end, row = function(k)
    local row = {}
    for j = 1, n do row[j] = j == k and 1 or 0 end
    return row
  end }
  for k = 1, n do bounds.at[k], bounds.low[k], bounds.high[k] = 0, low, high end
  local step = quadratic.solve(B, g, { b }, { -wanted }, { 0 }, bounds)
  local left, right = -1e3, 1e3
  for _ = 1, 200 do
    local m = (left + right) / 2
    if linear.dot(b, clipped(a, b, m, low, high)) < wanted then left = m else right = m end
  end
  local p = clipped(a, b, left, low, high)
  if math.abs(linear.dot(b, p) - wanted) > 1e-9 then assert(not step, "out of reach, and a step") else
    for k = 1, n do assert(math.abs(step.p[k] - p[k]) < 1e-9, ("%d: %.17g %.17g"):format(k, step.p[k], p[k])) end
    local slope = step.slope -- with H p: nothing is left
    for k = 1, n do assert(math.abs(slope[k] + 2 * step.p[k]) < 1e-9) end
    kept_some = kept_some + 1
  end
end
assert(kept_some > 20 and kept_some < 40, kept_some)

-- ---- Rosenbrock's valley with its end held by an equation and by a bound ----

local function valley(y) return (1 - y[1]) ^ 2 + 100 * (y[2] - y[1] ^ 2) ^ 2 end
local function valley_slope(y)
  local off = y[2] - y[1] ^ 2
  return { -2 * (1 - y[1]) - 400 * off * y[1], 200 * off }
end

local found = assert(sqp.minimise { start = { -1.2, 1 }, most = 100, tolerance = 1e-8, evaluate = function(y)
  return { cost = valley(y), slope = valley_slope(y), c = {}, A = {} }
end })
assert(found.ended == "converged" and math.abs(found.y[1] - 1) < 1e-6 and math.abs(found.y[2] - 1) < 1e-6)

found = assert(sqp.minimise { start = { 1.2, 1 }, most = 100, tolerance = 1e-8, evaluate = function(y)
  return { cost = valley(y), slope = valley_slope(y), c = { y[1] ^ 2 + y[2] ^ 2 - 1 }, A = { { 2 * y[1], 2 * y[2] } } }
end })
local x, y = found.y[1], found.y[2] -- the known point of the circle: 0.7864, 0.6177
assert(math.abs(x - 0.7864151509) < 1e-7 and math.abs(y - 0.6176983125) < 1e-7, ("%.10f %.10f"):format(x, y))

-- ---- no least value ----

local none, why = sqp.minimise { start = { 1, 1 }, most = 200, tolerance = 1e-8, evaluate = function(z)
  return { cost = -z[1], slope = { -1, 0 }, c = {}, A = {} }
end }
assert(not none and why:find("no lower bound", 1, true), why)

-- ---- what is on file ----

local memory = require("common.optimise.memory")
local path = os.tmpname()
local function answer() return { misses = { 1 / 3, -0.0 }, slopes = { { math.pi, 1e-300 }, {} }, dt = 0.1, integrator = "rk4" } end
local first = assert(memory.open(path, "this"))
first:recall("a", { 0.1 }, answer)
local again = assert(memory.open(path, "this"))
local same = again:recall("a", { 0.1 }, function() error("taken again") end)
assert(same.misses[1] == 1 / 3 and same.slopes[1][1] == math.pi and same.slopes[1][2] == 1e-300 and same.dt == 0.1 and again.taken == 0)
again:recall("a", { 0.1 + 2 ^ -56 }, answer)
again:recall("b", { 0.1 }, answer)
assert(again.taken == 2)
local other = assert(memory.open(path, "that"))
other:recall("a", { 0.1 }, answer)
assert(other.taken == 1)
other:remove()
assert(not io.open(path))
