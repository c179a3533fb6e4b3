-- Spread of samples: quantiles and deviations that are known, normally distributed values, and what a sweep writes of them.
local root, build = assert(os.getenv("HK_ROOT"), "HK_ROOT"), assert(os.getenv("HK_BUILD"), "HK_BUILD")
package.path = ("%s/tools/?.lua;%s/scripts/lib/?.lua;%s/tests/support/?.lua;%s"):format(root, root, root, package.path)
for _, name in ipairs { "luasql.sqlite3", "lfs" } do
  if not pcall(require, name) then
    print("skipped: Lua's " .. name .. " is not installed")
    os.exit(77)
  end
end
local files = require("files")
local ranges = require("ranges")
local spread = require("common.sweep.spread")

local function near(a, b, by) assert(math.abs(a - b) <= by, ("%.12g is not %.12g"):format(a, b)) end

-- ---- numbers ----

local s = spread.of { 5, 1, 4, 2, 3 }
assert(s.count == 5 and s.mean == 3 and s.median == 3)
near(s.sd, math.sqrt(2.5), 1e-15)
near(s.low, 1.2, 1e-15)
near(s.high, 4.8, 1e-15)
assert(spread.of {} == nil and spread.of({ 7 }).median == 7 and spread.of({ 7 }).sd ~= spread.of({ 7 }).sd)

-- 20,000 values of mean 10 and deviation 1: the mean is off by 0.007, the deviation by 0.005, the quantiles of 5 and 95 % by
-- 0.015; four times that is allowed, and 0.013 of the part within one deviation, 0.6827.
local list = ranges.draw(ranges.normal(9, 11, 20000), 7, "k")
s = spread.of(list)
near(s.mean, 10, 0.028)
near(s.sd, 1, 0.02)
near(s.low, 10 - 1.644854, 0.06)
near(s.high, 10 + 1.644854, 0.06)
local within = 0
for _, x in ipairs(list) do within = within + (math.abs(x - 10) < 1 and 1 / #list or 0) end
near(within, 0.682689, 0.013)
near(math.log(spread.of(ranges.draw(ranges.parse("10..1000:normal:log:20000"), 7, "k")).median, 10), 2, 0.04)

-- ---- a sweep ----

local folder = os.tmpname()
os.remove(folder)
assert(os.execute("mkdir -p " .. folder))
files.write(folder .. "/sum.lua", [[
local a, b = param("a", 1), param("b", 1)
local scene = hooke.scene { duration = 0.1, fps = 10, integrator = "rk4", dt = 0.1 }
local p = scene:particle { position = { a, b, 0 } }
scene:measure("sum", function(s) local x = s:position(p) return 2 * x[1] + x[2] end)
return scene
]])
assert(os.execute(("cd %s && %s/hooke sweep sum.lua a=9..11:normal:12 b=1,5 --csv all.csv --quiet"):format(folder, build)))
local of_a = {} -- the draws, by the table of all cases
for a, b in files.read(folder .. "/all.csv"):gmatch("\n%d+,sum,([^,]+),([^,]+)") do
  if b == "1" then of_a[#of_a + 1] = tonumber(a) end
end
s = spread.of(of_a)
local text = files.read(folder .. "/out/sweep/sum-spread.csv")
assert(#of_a == 12 and text:find("^of,measure,samples,mean,sd,q05,q50,q95\n"), text)
for _, b in ipairs { 1, 5 } do
  local mean, sd, low = text:match(("\nb = %d,sum,12,([^,]+),([^,]+),([^,]+)"):format(b))
  near(tonumber(mean), 2 * s.mean + b, 1e-12)
  near(tonumber(sd), 2 * s.sd, 1e-12)
  near(tonumber(low), 2 * s.low + b, 1e-12)
end

-- By gradients: of a linear measure the same to rounding, with two parameters that are drawn together; of a square the mean is the
-- square of the mean, a variance (n - 1)/n of the samples' less, and the deviation 2 m sd.
files.write(folder .. "/both.lua", [[
local a, b, c = param("a", 1.5), param("b", 1.5), param("c", 0)
local scene = hooke.scene { duration = 0.5, fps = 10, integrator = "rk4", dt = 0.1 }
local p = scene:particle { position = { a, b, 0 }, velocity = { b, 0, 0 } }
scene:force("gravity", {})
scene:measure("sum", function(s) local x = s:position(p) return 2 * x[1] + x[2] + c end)
scene:measure("square", function(s) return s:position(p)[2] ^ 2 end)
return scene
]])
assert(os.execute(("cd %s && %s/hooke sweep both.lua a=9..11:normal:12 b=2..3:random:12 c=0,5 --linear --csv all.csv --quiet"):format(
  folder, build)))
local of_b = {}
for b, c in files.read(folder .. "/all.csv"):gmatch("\n%d+,both,[^,]+,([^,]+),([^,]+)") do
  if c == "0" then of_b[#of_b + 1] = tonumber(b) end
end
s, text = spread.of(of_b), files.read(folder .. "/out/sweep/both-spread.csv")
assert(#of_b == 12 and text:find(",linear_mean,linear_sd,linear_q05,linear_q50,linear_q95\n", 1, true), text)
for _, c in ipairs { 0, 5 } do
  local row, cells = text:match(("\nc = %d,sum,12,([^\n]+)"):format(c)), {}
  for cell in row:gmatch("[^,]+") do cells[#cells + 1] = tonumber(cell) end
  assert(#cells == 10, row)
  for k = 1, 5 do near(cells[k + 5], cells[k], 1e-9) end
  row, cells = text:match(("\nc = %d,square,12,([^\n]+)"):format(c)), {}
  for cell in row:gmatch("[^,]+") do cells[#cells + 1] = tonumber(cell) end
  near(cells[6], s.mean ^ 2, 1e-9)
  near(cells[1] - cells[6], s.sd ^ 2 * 11 / 12, 1e-9)
  near(cells[7], 2 * s.mean * s.sd, 1e-8)
end

-- Of what has no gradient it says why.
local file = assert(io.popen(("cd %s && %s/hooke sweep both.lua a=9..11:normal:4 --integrators dopri5 --linear --db no.db 2>&1"):format(
  folder, build)))
text = file:read("a")
file:close()
assert(text:find("sum  has no gradient: integrator 'dopri5' does not state its step as stages", 1, true), text)

-- Without samples there is nothing to say.
assert(os.execute(("cd %s && %s/hooke sweep sum.lua b=1,5 --db plain.db --quiet"):format(folder, build)))
assert(not files.read(folder .. "/plain-spread.csv"))
os.execute("rm -r " .. folder)
