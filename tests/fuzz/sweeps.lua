-- Random sweeps, scripts and command lines, most of which only list their cases; see tests/support/fuzz/run.lua.
package.path = assert(os.getenv("HK_ROOT")) .. "/tests/support/?.lua;" .. package.path
local run = require("fuzz.run")
local values = require("fuzz.values")
local chance, pick = values.chance, values.pick

local scene = [[
local k = param("k", 10, "stiffness")
local n = param("n", 2, "particles", { min = 2, max = 100 })
local s = hooke.scene { duration = 0.02, fps = 50, integrator = "leapfrog" }
local h = s:strand { n = n, from = { 0, 0, 0 }, to = { 1, 0, 0 } }
s:force("springs", { edges = h:structural(), k = k })
s:measure("x", function(state) return state:position(2)[1] end)
return s
]]

-- ---- scripts ----

local function strange() return values.strange():gsub("%f[%w]([sher])%.", "string."):gsub("^[sherp]$", "nil") end
local function or_strange(text) return chance(0.06) and strange() or text end

local ranges = { "{ 1, 2 }", "{ 10 }", "3", "ranges.linear(1, 5, 3)", "ranges.log(1, 100, 3)", "ranges.random(1, 5, 2)",
  "ranges.latin(2, 9, 2)", "ranges.whole(ranges.log(2, 20, 3))", "ranges.random(1, 5, 2, 'log')", "{ 'a', true }",
    "ranges.linear(%s, %s, %s)",
  "ranges.whole(%s)" }

local function range() return (or_strange(pick(ranges)):gsub("%%s", function() return (strange()) end)) end

local function integrators()
  local list = {}
  for k = 1, math.random(1, 3) do
    list[k] = or_strange(pick { "'leapfrog'", "'rk4'", "'xpbd:substeps=2'", "{ 'bdf2', dt = 0.01, label = 'b' }", "'euler:'",
      "'nope'",
      "{ 'rk4', tol = 1e-3, solver = 'pcg' }", "'xpbd:substeps=x,bdf='" })
  end
  return ("{ %s }"):format(table.concat(list, ", "))
end

local plots = { "{ measure = 'x', over = 'k' }", "{ measure = 'x', over = { 'k', 'n' } }", "{ path = 1 }",
  "{ path = 1, panels = { 'n' } }",
  "{ measure = 'nope', over = 'k' }", "{ measure = 'x' }", "{}", "{ measure = 'x', over = 'k', name = '../x', width = -1 }",
  "{ measure = 'x', over = 'k', curves = 1, range = 2, title = {} }", "1" }

local fields = {
  params = function() return ("{ k = %s, %s }"):format(range(), chance(0.5) and "n = " .. range() or "") end,
  integrators = integrators,
  solvers = function() return pick { "{ 'pcg' }", "{ 'auto', 'cholmod' }", "'pcg'" } end,
  dt = range, tol = range,
  repeats = function() return tostring(math.random(1, 3)) end,
  seed = function() return tostring(math.random(0, 3)) end,
  measures = function() return pick { "{ 'x' }", "{ 'steps', 'x' }", "{ 'nope' }", "{}" } end,
  paths = function() return pick { "{ 1 }", "{ 1, 2 }", "1", "{ 99 }" } end,
  plots = function() return ("{ %s }"):format(or_strange(pick(plots))) end,
  jobs = function() return "1" end, timeout = function() return "5" end, step_limit = function() return "100" end,
  verify = function() return "true" end, accuracy = function() return "0.1" end, threads = function() return "1" end,
  ["['until']"] = function() return "0.01" end, name = function() return pick { "'a'", "'a/b'", "'../a'", "''", "' '" } end,
  trust = function() return "true" end, nope = function() return "1" end,
}
local names = {}
for name in pairs(fields) do names[#names + 1] = name end
table.sort(names)

local rare = { trust = true, nope = true, name = true }

local function script()
  local list = { "scene = " .. or_strange(pick { "'scene.lua'", "'./scene.lua'", "{ 'scene.lua', 'scene.lua' }", "'none.lua'",
    "'sweep.lua'" }),
    "params = " .. or_strange(fields.params()) }
  for _, name in ipairs(names) do
    if name ~= "params" and chance(rare[name] and 0.02 or 0.15) then
      list[#list + 1] = ("%s = %s"):format(name, or_strange(fields[name]()))
    end
  end
  return ("local ranges = require('ranges')\nlocal knot, deep, meta = {}, {{{}}}, setmetatable({}, { __index = print })\n" ..
    "knot[1] = knot\nreturn hooke.sweep { %s }\n"):format(table.concat(list, ",\n  "))
end

-- ---- command lines ----

local spans = { "16,32", "1e2..1e6:log:3", "0..1:linear:2", "0..1:random:2", "1..9:latin:2", "2..9:log:3:whole", "", ",", "..",
  "1..2", "1..2:3:4",
  "1..:2", "nan..1:2", "0..1:log:2", "1..2:random:latin:2", "1..2:0", "1..2:99999999999", "-1..1:linear:3", "1e999..2:2",
    "true,false,x", "1:2",
  "0x10", "1..2:log:log:2:whole:whole" }
local options = { "--print-cases", "--quiet", "--report", "--resume", "--again", "--retry", "--case 1", "--case 1-2",
  "--case 0", "--case x",
  "--case 1-", "--case 2-1", "--seed 3", "--seed x", "-j 1", "-j 0", "-j", "--timeout 0", "--timeout -1", "--until 0.01",
    "--until nan",
  "--repeats 2", "--repeats 0", "--measures x", "--measures ,", "--dt 0.01", "--dt 0.01,0.02", "--dt -1", "--tol 1e-3",
    "--plot x:k",
  "--plot x", "--plot :", "--plot x:k,n", "--csv out.csv", "--csv .", "--csv /dev/full", "--db a.db", "--db .",
    "--db none/../b.db",
  "--db scene.lua", "--part p.db", "--merge p.db", "--merge scene.lua", "--integrators rk4,euler", "--integrators nope",
    "--integrators ''",
  "--integrators xpbd:substeps=2,rk4", "--verify", "--trust", "--help", "--nope", "--slurm", "--tasks 0", "--sbatch x", "--wait" }

-- Sweeps whose whole file is put into the queue of a machine, or which run for minutes, are not tried.
local function words()
  local list = { chance(0.7) and "sweep.lua" or "scene.lua" }
  for _ = 1, math.random(0, 2) do list[#list + 1] = ("%s='%s'"):format(pick { "k", "n", "k", "n", "z", "" }, pick(spans)) end
  for _ = 1, math.random(0, 2) do list[#list + 1] = pick(options) end
  if chance(0.75) then list[#list + 1] = "--print-cases" end
  if chance(0.03) then table.remove(list, 1) end
  return "sweep " .. table.concat(list, " ")
end

local found = {
  { "no sweep is named", words = "sweep --print-cases", code = 1, says = "sweep: no sweep given", files = {} },
  { "a text that commands the terminal", words = "sweep sweep.lua", code = 1,
    says = "the text 'a\\x1b[2J' has control",
    files = { ["sweep.lua"] = "return hooke.sweep { scene = 'scene.lua', integrators = { 'a\\27[2J' } }" } },
}

run.fuzz {
  name = "sweeps",
  found = found,
  cases = 15,
  make = function()
    values.strangeness = 0.05
    return { files = { ["scene.lua"] = scene, ["sweep.lua"] = script() }, words = words() }
  end,
}
